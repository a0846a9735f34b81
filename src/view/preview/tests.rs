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

/// A table as shaders read it.
fn shader_table(format: TexelFormat) -> Arc<ShaderTable> {
    Arc::new(ShaderTable::new(&planted(), format))
}

/// Tables of both layouts and both formats, and a table of isotropic surfaces, as shaders read them.
fn shader_tables() -> [Arc<ShaderTable>; 4] {
    let tables = [
        (planted(), TexelFormat::F32),
        (planted(), TexelFormat::F16),
        (reflected(), TexelFormat::F32),
        (isotropic(), TexelFormat::F32),
    ];
    tables.map(|(table, format)| Arc::new(ShaderTable::new(&table, format)))
}

/// The renderers of this machine. Without a Vulkan adapter the tests only use the CPU, and report it on standard error
/// directly, because the harness would capture a print.
fn renderers() -> Vec<Preview> {
    let mut gpu = Preview::new(Adapter::Gpu);
    let cpu = Preview::new(Adapter::Cpu);
    match gpu.adapter_name() {
        Ok(_) => vec![gpu, cpu],
        Err(PreviewError::NoAdapter(reason)) => {
            report_skipped(&reason);
            vec![cpu]
        }
        Err(error) => panic!("{error}"),
    }
}

/// Reports that the current test skips the GPU, and the reason.
pub(crate) fn report_skipped(reason: &str) {
    let name = std::thread::current().name().unwrap_or_default().to_owned();
    let line = format!(
        "\n*** SKIPPED ON THE GPU: {name}: {reason}\n*** Install a Vulkan driver (Debian: mesa-vulkan-drivers).\n\n"
    );
    // A failed print does not fail the test.
    let _ = stderr().write_all(line.as_bytes());
}
