//! The two renderers against each other and against independent references.

mod closed_form;
mod cut;
mod layers;
mod listed;
mod lookups;
mod normals;
mod pictures;
mod planted;
mod polygons;
mod ported;
mod prefilter;
mod printed;
mod shapes;
mod textured;
mod textured_cut;
mod truth;
mod twins;
mod without_textures;

use std::{
    io::{Write as _, stderr},
    sync::Arc,
};

pub(super) use planted::{isotropic, planted, reflected};

use super::{Adapter, Preview, PreviewError, ShaderTable, TexelFormat};

/// A table as shaders have it.
fn shader_table(format: TexelFormat) -> Arc<ShaderTable> {
    Arc::new(ShaderTable::new(&planted(), format))
}

/// Tables of both layouts and both widths, and one of isotropic surfaces, as shaders have them.
fn shader_tables() -> [Arc<ShaderTable>; 4] {
    let tables = [
        (planted(), TexelFormat::F32),
        (planted(), TexelFormat::F16),
        (reflected(), TexelFormat::F32),
        (isotropic(), TexelFormat::F32),
    ];
    tables.map(|(table, format)| Arc::new(ShaderTable::new(&table, format)))
}

/// The renderers of this machine. Without a Vulkan adapter only the CPU is tested, and the test says so on standard
/// error itself, since the harness would capture it.
fn renderers() -> Vec<Preview> {
    let mut gpu = Preview::new(Adapter::Gpu);
    let cpu = Preview::new(Adapter::Cpu);
    match gpu.adapter_name() {
        Ok(_) => vec![gpu, cpu],
        Err(PreviewError::NoAdapter(reason)) => {
            tell_skipped(&reason);
            vec![cpu]
        }
        Err(error) => panic!("{error}"),
    }
}

/// Says that the current test leaves out the GPU, and why.
pub(crate) fn tell_skipped(reason: &str) {
    let name = std::thread::current().name().unwrap_or_default().to_owned();
    let line = format!(
        "\n*** SKIPPED ON THE GPU: {name}: {reason}\n*** Install a Vulkan driver (Debian: mesa-vulkan-drivers).\n\n"
    );
    // A line that cannot be printed does not fail the test.
    let _ = stderr().write_all(line.as_bytes());
}
