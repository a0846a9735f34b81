//! Register and instruction counts of a compute shader, from the compiler of a Vulkan driver:
//! `VK_KHR_pipeline_executable_properties`.
//!
//! Mesa's RADV can compile for a GPU that is not installed. The environment variable [`FAMILY_VARIABLE`] must name the
//! GPU before the driver is loaded. The counts are equal on all machines with the same version of Mesa.

use std::ffi::{CStr, CString};

use ash::{khr::pipeline_executable_properties, vk};

/// The environment variable that names the GPU for which RADV compiles. The GPU need not be installed.
pub const FAMILY_VARIABLE: &str = "RADV_FORCE_FAMILY";

/// The compiler's counts for a shader.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Figures {
    /// Vector registers per thread.
    pub registers: u64,
    /// The number of these registers that are spilled to memory.
    pub spilled: u64,
    /// Instructions.
    pub instructions: u64,
    /// Cycles for a group of threads, without stalls.
    pub inverse_throughput: u64,
}

/// The type of a binding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Resource {
    /// A uniform buffer.
    Uniform,
    /// A storage buffer.
    Storage,
    /// A texture that is sampled.
    Texture,
    /// A sampler.
    Sampler,
}

/// The reason that no counts are available.
#[derive(Debug, thiserror::Error)]
pub enum DriverError {
    /// There is no loader, or no driver that compiles for the named GPU.
    #[error(
        "no driver reports costs: install Mesa's RADV (Debian: mesa-vulkan-drivers) and set {FAMILY_VARIABLE}, for example to navi21; {0}"
    )]
    Absent(String),
    /// The driver rejects the shader.
    #[error("{0}")]
    Refused(#[from] vk::Result),
    /// The name of the entry point contains a zero byte.
    #[error("the name of the entry point contains a zero byte")]
    Name(#[from] std::ffi::NulError),
}

/// A RADV device. Its objects live until the process ends.
pub struct Driver {
    device: ash::Device,
    statistics: pipeline_executable_properties::Device,
    name: String,
    // The library that contains the functions above.
    _entry: ash::Entry,
}

impl Driver {
    /// Opens the RADV device for the GPU of [`FAMILY_VARIABLE`].
    ///
    /// # Errors
    /// [`DriverError::Absent`].
    pub fn open() -> Result<Self, DriverError> {
        let absent = |error: vk::Result| DriverError::Absent(error.to_string());
        // SAFETY: the system's library with the name of Vulkan is Vulkan.
        let entry = unsafe { ash::Entry::load() }.map_err(|error| DriverError::Absent(error.to_string()))?;
        let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_2);
        let info = vk::InstanceCreateInfo::default().application_info(&application);
        // SAFETY: the data behind `info` lives until the call returns. This also holds for the calls below.
        let instance = unsafe { entry.create_instance(&info, None) }.map_err(absent)?;
        // SAFETY: the instance was created above and is not destroyed.
        let all = unsafe { instance.enumerate_physical_devices() }.map_err(absent)?;
        let Some((physical, name)) = all.into_iter().find_map(|physical| Some((physical, name(&instance, physical)?)))
        else {
            return Err(DriverError::Absent("RADV lists no device".to_owned()));
        };
        let queues = [vk::DeviceQueueCreateInfo::default().queue_priorities(&[1.0])];
        let extensions = [pipeline_executable_properties::NAME.as_ptr()];
        let mut executable_info =
            vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default().pipeline_executable_info(true);
        // WGSL storage buffers need this feature.
        let mut memory = vk::PhysicalDeviceVulkan12Features::default()
            .vulkan_memory_model(true)
            .vulkan_memory_model_device_scope(true);
        let info = vk::DeviceCreateInfo::default().queue_create_infos(&queues).enabled_extension_names(&extensions);
        let info = info.push_next(&mut executable_info).push_next(&mut memory);
        // SAFETY: as above.
        let device = unsafe { instance.create_device(physical, &info, None) }.map_err(absent)?;
        let statistics = pipeline_executable_properties::Device::new(&instance, &device);
        Ok(Self { device, statistics, name, _entry: entry })
    }

    /// The name of the device, and the driver's version.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The counts for an entry point of a compute shader in SPIR-V. Its resources must be in group 0.
    ///
    /// # Errors
    /// [`DriverError::Refused`], [`DriverError::Name`].
    pub fn figures(&self, spirv: &[u32], entry: &str, resources: &[(u32, Resource)]) -> Result<Figures, DriverError> {
        let entry = CString::new(entry)?;
        let bindings: Vec<_> = resources
            .iter()
            .map(|(binding, resource)| {
                let kind = match resource {
                    Resource::Uniform => vk::DescriptorType::UNIFORM_BUFFER,
                    Resource::Storage => vk::DescriptorType::STORAGE_BUFFER,
                    Resource::Texture => vk::DescriptorType::SAMPLED_IMAGE,
                    Resource::Sampler => vk::DescriptorType::SAMPLER,
                };
                let binding = vk::DescriptorSetLayoutBinding::default().binding(*binding).descriptor_type(kind);
                binding.descriptor_count(1).stage_flags(vk::ShaderStageFlags::COMPUTE)
            })
            .collect();
        let layout = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        let module = vk::ShaderModuleCreateInfo::default().code(spirv);
        let device = &self.device;
        // SAFETY: all handles belong to this device, and all arguments live until the calls return. The objects live
        // until the process ends, like the device.
        unsafe {
            let sets = [device.create_descriptor_set_layout(&layout, None)?];
            let layout = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets);
            let layout = device.create_pipeline_layout(&layout, None)?;
            let module = device.create_shader_module(&module, None)?;
            let stage = vk::PipelineShaderStageCreateInfo::default().stage(vk::ShaderStageFlags::COMPUTE);
            let stage = stage.module(module).name(&entry);
            let info = vk::ComputePipelineCreateInfo::default().stage(stage).layout(layout);
            let info = [info.flags(vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR)];
            let made =
                device.create_compute_pipelines(vk::PipelineCache::null(), &info, None).map_err(|(_, error)| error)?;
            let executable = vk::PipelineExecutableInfoKHR::default().pipeline(made[0]);
            let all = self.statistics.get_pipeline_executable_statistics(&executable)?;
            let figure = |name: &CStr| {
                let found = all.iter().find(|figure| figure.name_as_c_str().is_ok_and(|other| other == name));
                // All RADV counts have this type.
                found.map_or(0, |figure| figure.value.u64)
            };
            Ok(Figures {
                registers: figure(c"VGPRs"),
                spilled: figure(c"Spilled VGPRs"),
                instructions: figure(c"Instructions"),
                inverse_throughput: figure(c"Inverse Throughput"),
            })
        }
    }
}

/// The name of a RADV device, and the driver's version. `None` for a device of another driver.
fn name(instance: &ash::Instance, physical: vk::PhysicalDevice) -> Option<String> {
    let mut driver = vk::PhysicalDeviceDriverProperties::default();
    let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
    // SAFETY: the device belongs to this instance.
    unsafe { instance.get_physical_device_properties2(physical, &mut properties) };
    let name = properties.properties.device_name_as_c_str().ok()?.to_string_lossy().into_owned();
    let version = driver.driver_info_as_c_str().ok()?.to_string_lossy().into_owned();
    (driver.driver_id == vk::DriverId::MESA_RADV).then(|| format!("{name}, {version}"))
}
