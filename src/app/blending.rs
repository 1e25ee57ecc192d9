//! Blending of egui's translucent colours in gamma space, as egui expects, instead of linear space.
//!
//! bevy_egui 0.42 passes premultiplied colours to a pipeline that blends in linear space: half-transparent white over white
//! becomes grey. Here its shader is changed to output encoded colours, and the camera to composite in that space; Bevy
//! converts the finished frame for the screen. If a later bevy_egui has a different shader, blending stays linear.

use bevy::camera::{CompositingSpace, Hdr};
use bevy::prelude::*;
use bevy::shader::{Shader, Source};
use bevy_egui::render::EGUI_SHADER_HANDLE;

/// Last line of bevy_egui's shader, and its replacement.
const LINEAR: &str = "return vec4<f32>(linear_from_gamma_rgb(color_gamma.rgb), color_gamma.a);";
const ENCODED: &str = "return color_gamma;";

/// Changes the shader, and spawns a camera for it.
pub(super) fn spawn_camera(mut commands: Commands, mut shaders: ResMut<Assets<Shader>>) {
    // egui antialiases its own edges: multisampling would only cost time.
    let mut camera = commands.spawn((Camera2d, Msaa::Off));
    let Some(mut shader) = shaders.get_mut(&EGUI_SHADER_HANDLE) else { return };
    let Source::Wgsl(text) = &shader.source else { return };
    if text.contains(LINEAR) {
        let text = text.replace(LINEAR, ENCODED);
        let path = shader.path.clone();
        *shader = Shader::from_wgsl(text, path);
        // Only the pipeline of a camera with an HDR target leaves the colours as they are.
        camera.insert((Hdr, CompositingSpace::Srgb));
    }
}
