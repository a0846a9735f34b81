//! Compares the two renderers with each other and with independent references.

mod closed_form;
mod cut;
mod formula;
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
mod samplers;
mod shapes;
mod textured;
mod textured_cut;
mod truth;
mod twins;
mod without_textures;

use std::{
    io::{Write as _, stderr},
    ops::{Deref, DerefMut},
    sync::{Arc, Mutex},
};

pub(super) use planted::{isotropic, planted, reflected};

use super::{Adapter, Preview, PreviewError, ShaderTable, TexelFormat};

/// A table in the form that shaders read.
fn shader_table(format: TexelFormat) -> Arc<ShaderTable> {
    Arc::new(ShaderTable::new(&planted(), format))
}

/// Tables in the form that shaders read: both layouts, both formats, and a table of isotropic surfaces.
fn shader_tables() -> [Arc<ShaderTable>; 4] {
    let tables = [
        (planted(), TexelFormat::F32),
        (planted(), TexelFormat::F16),
        (reflected(), TexelFormat::F32),
        (isotropic(), TexelFormat::F32),
    ];
    tables.map(|(table, format)| Arc::new(ShaderTable::new(&table, format)))
}

/// The renderers of this machine. Without a Vulkan adapter, tests only use the CPU. They report this directly on
/// standard error, because the test harness would capture a print.
fn renderers() -> Renderers {
    let idle = IDLE.lock().expect("no test panics here").pop();
    let mut gpu = idle.unwrap_or_else(|| Preview::new(Adapter::Gpu));
    let cpu = Preview::new(Adapter::Cpu);
    match gpu.adapter_name() {
        Ok(_) => Renderers(vec![gpu, cpu]),
        Err(PreviewError::NoAdapter(reason)) => {
            report_skipped(&reason);
            Renderers(vec![cpu])
        }
        Err(error) => panic!("{error}"),
    }
}

/// GPU renderers that no test uses now. Tests share them, so that each pipeline is compiled once per test thread.
static IDLE: Mutex<Vec<Preview>> = Mutex::new(Vec::new());

/// A GPU renderer, which returns to [`IDLE`], and a CPU renderer.
struct Renderers(Vec<Preview>);

impl Drop for Renderers {
    fn drop(&mut self) {
        if self.0.len() > 1 {
            IDLE.lock().expect("no test panics here").push(self.0.swap_remove(0));
        }
    }
}

impl Deref for Renderers {
    type Target = [Preview];

    fn deref(&self) -> &[Preview] {
        &self.0
    }
}

impl DerefMut for Renderers {
    fn deref_mut(&mut self) -> &mut [Preview] {
        &mut self.0
    }
}

/// Reports that the current test skips the GPU, and the reason.
pub(crate) fn report_skipped(reason: &str) {
    let name = std::thread::current().name().unwrap_or_default().to_owned();
    let line = format!(
        "\n*** SKIPPED ON THE GPU: {name}: {reason}\n*** Install a Vulkan driver (Debian: mesa-vulkan-drivers).\n\n"
    );
    // A failed print should not fail the test.
    let _ = stderr().write_all(line.as_bytes());
}
