//! Translucent colours as egui means them: blended as they are encoded (gamma space), not by light.
//!
//! bevy_egui 0.42 hands its colours, multiplied by their alpha before, to a pipeline that blends linear light: half
//! transparent white over white becomes grey. So its shader is told to give its colours as they are, and the camera to
//! composite in that space; Bevy converts the finished picture for the screen. If a later bevy_egui has another shader,
//! nothing is changed.

use bevy::camera::{CompositingSpace, Hdr};
use bevy::prelude::*;
use bevy::shader::{Shader, Source};
use bevy_egui::render::EGUI_SHADER_HANDLE;

/// How bevy_egui's shader ends, and how it should.
const LINEAR: &str = "return vec4<f32>(linear_from_gamma_rgb(color_gamma.rgb), color_gamma.a);";
const ENCODED: &str = "return color_gamma;";

/// Changes the shader, and spawns the camera that goes with it.
pub(super) fn spawn_camera(mut commands: Commands, mut shaders: ResMut<Assets<Shader>>) {
    // egui smooths its own edges and draws past the samples; clearing four of each pixel would only cost time.
    let mut camera = commands.spawn((Camera2d, Msaa::Off));
    let Some(mut shader) = shaders.get_mut(&EGUI_SHADER_HANDLE) else { return };
    let Source::Wgsl(text) = &shader.source else { return };
    if text.contains(LINEAR) {
        let text = text.replace(LINEAR, ENCODED);
        let path = shader.path.clone();
        *shader = Shader::from_wgsl(text, path);
        // Only the pipeline of a camera with a wide target takes the colours as they come.
        camera.insert((Hdr, CompositingSpace::Srgb));
    }
}
