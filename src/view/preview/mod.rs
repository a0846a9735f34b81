//! Previews of a table: metal under an area light, by the table and by Monte Carlo integration.
//!
//! The GPU runs the same shaders that users add to their own renderers. `cpu` is their twin in Rust. It renders if
//! there is no adapter, and tests compare the GPU with it. Both read the same `frame`, and share all steps after
//! radiance, such as differences and labels. `parameters` declares the fields of a scene that callers can choose.
//!
//! Invariant: `preview` has no access to files, HTTP or recipes; equal scenes and tables give equal bytes on the same
//! adapter.

mod bounds;
mod choices;
mod compose;
mod cost;
mod cpu;
mod error;
mod estimator;
mod frame;
mod gpu;
mod light;
mod light_picture;
mod named;
mod panel_error;
mod parameter;
mod parameters;
mod radiances;
mod renderer;
mod scene;
mod scene_picture;
mod shadows;
mod table;
mod tone;

pub use bounds::{PictureFault, SceneFault};
pub use choices::Choices;
pub use error::{PreviewError, TableFault};
pub use estimator::{Estimator, Stop};
pub use gpu::Weights;
#[cfg(test)]
pub(super) use gpu::{GpuFailure, tests::decoder::run as run_decoder};
pub use named::NamedScene;
pub use panel_error::PanelError;
pub use parameter::{Parameter, ParameterForm, Value};
pub use parameters::PARAMETERS;
pub use radiances::Radiances;
pub use renderer::{Adapter, Preview, Rendered};
pub use scene::{Camera, Light, LightKind, LobeView, Material, Mode, Scene, Surface};
pub use scene_picture::ScenePicture;
pub use table::{ShaderTable, TexelFormat};

#[cfg(test)]
mod tests;
#[cfg(test)]
pub(super) use tests::report_skipped;
