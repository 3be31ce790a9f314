//! A GPU's compiler without the GPU: Mesa's RADV makes pipelines for a card that it is told of, and says what they need.

use afmsweep::kernel::{Binding, ShaderSpec};
use ash::{khr, vk};
use std::ffi::{CStr, CString, c_char};

/// An open device of a driver that is told which card to compile for.
pub struct Device {
    device: ash::Device,
    told: khr::pipeline_executable_properties::Device,
    /// The card and the driver's version, as the driver names them.
    pub card: String,
    pub driver: String,
    // The library stays loaded as long as the device is used.
    _entry: ash::Entry,
}

/// What the compiler made of a shader.
pub struct Compiled {
    /// The driver's numbers by their names.
    pub statistics: Vec<(String, u64)>,
    pub assembly: String,
}

fn text(letters: &[c_char]) -> String {
    let bytes: Vec<u8> = letters.iter().map(|letter| *letter as u8).take_while(|byte| *byte != 0).collect();
    String::from_utf8_lossy(&bytes).into_owned()
}

impl Device {
    /// The first device that the loader finds.
    pub fn open() -> Result<Self, String> {
        let failed = |what: &str, why: &dyn std::fmt::Display| format!("{what}: {why}");
        // SAFETY: Vulkan's calls get what its specification asks for, and what they return lives as long as `Device` does.
        unsafe {
            let entry = ash::Entry::load().map_err(|why| failed("no Vulkan loader", &why))?;
            let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_2);
            let info = vk::InstanceCreateInfo::default().application_info(&application);
            let instance = entry.create_instance(&info, None).map_err(|why| failed("no instance", &why))?;
            let all = instance.enumerate_physical_devices().map_err(|why| failed("no device", &why))?;
            let physical = *all.first().ok_or("the driver names no device")?;
            let mut driver = vk::PhysicalDeviceDriverProperties::default();
            let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
            instance.get_physical_device_properties2(physical, &mut properties);
            let card = text(&properties.properties.device_name);
            let driver = format!("{} {}", text(&driver.driver_name), text(&driver.driver_info));
            let has = instance.get_physical_device_features(physical);
            let features = vk::PhysicalDeviceFeatures::default()
                .shader_float64(has.shader_float64 != 0)
                .shader_int64(has.shader_int64 != 0);
            let queues =
                [vk::DeviceQueueCreateInfo::default().queue_family_index(0).queue_priorities(&[1.0])];
            let names = [khr::pipeline_executable_properties::NAME.as_ptr()];
            let mut told = vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default()
                .pipeline_executable_info(true);
            let info = vk::DeviceCreateInfo::default()
                .queue_create_infos(&queues)
                .enabled_extension_names(&names)
                .enabled_features(&features)
                .push_next(&mut told);
            let device =
                instance.create_device(physical, &info, None).map_err(|why| failed("not opened", &why))?;
            let told = khr::pipeline_executable_properties::Device::new(&instance, &device);
            Ok(Self { device, told, card, driver, _entry: entry })
        }
    }

    /// Makes the pipeline of a shader whose words are given.
    pub fn compile(&self, spec: &ShaderSpec, words: &[u32]) -> Result<Compiled, vk::Result> {
        let bindings: Vec<_> = spec
            .bindings()
            .iter()
            .enumerate()
            .map(|(number, binding)| {
                vk::DescriptorSetLayoutBinding::default()
                    .binding(number as u32)
                    .descriptor_count(1)
                    .stage_flags(vk::ShaderStageFlags::COMPUTE)
                    .descriptor_type(match binding {
                        Binding::Uniform => vk::DescriptorType::UNIFORM_BUFFER,
                        Binding::Read | Binding::Write => vk::DescriptorType::STORAGE_BUFFER,
                    })
            })
            .collect();
        let point = CString::new(spec.entry.name()).expect("names have no zeros");
        let device = &self.device;
        // SAFETY: as above; the words are what naga wrote of a text that it has checked.
        unsafe {
            let module =
                device.create_shader_module(&vk::ShaderModuleCreateInfo::default().code(words), None)?;
            let set = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
            let sets = [device.create_descriptor_set_layout(&set, None)?];
            let layout = device
                .create_pipeline_layout(&vk::PipelineLayoutCreateInfo::default().set_layouts(&sets), None)?;
            let stage = vk::PipelineShaderStageCreateInfo::default()
                .stage(vk::ShaderStageFlags::COMPUTE)
                .module(module)
                .name(&point);
            let flags = vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR
                | vk::PipelineCreateFlags::CAPTURE_INTERNAL_REPRESENTATIONS_KHR;
            let info = vk::ComputePipelineCreateInfo::default().stage(stage).layout(layout).flags(flags);
            let made = device.create_compute_pipelines(vk::PipelineCache::null(), &[info], None);
            let pipeline = made.map_err(|(_, why)| why)?[0];
            let compiled = self.told(pipeline);
            device.destroy_pipeline(pipeline, None);
            device.destroy_pipeline_layout(layout, None);
            device.destroy_descriptor_set_layout(sets[0], None);
            device.destroy_shader_module(module, None);
            compiled
        }
    }

    /// What the driver tells of a pipeline.
    ///
    /// # Safety
    /// The pipeline is one of this device's, made with both flags for capturing.
    unsafe fn told(&self, pipeline: vk::Pipeline) -> Result<Compiled, vk::Result> {
        let info = vk::PipelineExecutableInfoKHR::default().pipeline(pipeline).executable_index(0);
        // SAFETY: the driver writes the texts into buffers of the lengths that it has asked for, and ends them with a zero.
        unsafe {
            let numbers = self.told.get_pipeline_executable_statistics(&info)?;
            let statistics = numbers.iter().map(|one| (text(&one.name), one.value.u64)).collect();
            let ask = self.told.fp().get_pipeline_executable_internal_representations_khr;
            let device = self.device.handle();
            let mut count = 0;
            ask(device, &info, &mut count, std::ptr::null_mut()).result()?;
            let mut texts = vec![vk::PipelineExecutableInternalRepresentationKHR::default(); count as usize];
            ask(device, &info, &mut count, texts.as_mut_ptr()).result()?;
            let mut kept: Vec<Vec<u8>> = texts.iter().map(|one| vec![0; one.data_size]).collect();
            for (one, space) in texts.iter_mut().zip(&mut kept) {
                one.p_data = space.as_mut_ptr().cast();
            }
            ask(device, &info, &mut count, texts.as_mut_ptr()).result()?;
            let place = texts.iter().position(|one| text(&one.name) == "Assembly");
            let assembly = place.and_then(|place| CStr::from_bytes_until_nul(&kept[place]).ok());
            let assembly = assembly.map_or_else(String::new, |text| text.to_string_lossy().into_owned());
            Ok(Compiled { statistics, assembly })
        }
    }
}
