//! A software renderer for `egui_kittest`: rasterises egui's triangles on the CPU.
//!
//! In: egui's output. Out: an image, bit-identical on every machine for the same triangles. Positions are snapped to 1/256
//! pixel and edges are evaluated in integers with the top-left rule, so that adjacent triangles neither overlap nor leave
//! gaps. Colours are blended premultiplied, in gamma space with 8 bits, as in egui's own renderers. Paint callbacks and
//! repeating textures are not supported.

use std::collections::HashMap;

use egui::epaint::{ImageDelta, Mesh, Primitive, Vertex};
use egui::{Color32, ImageData, TextureFilter, TextureId, TexturesDelta};
use egui_kittest::TestRenderer;
use image::RgbaImage;

/// Subpixel positions along each axis.
const SUB: i64 = 256;

/// The renderer. Use it as `Harness::builder().renderer(SoftwareRenderer::default())`.
#[derive(Default)]
pub struct SoftwareRenderer {
    textures: HashMap<TextureId, Texture>,
}

impl TestRenderer for SoftwareRenderer {
    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        for (id, images) in delta.set.drain() {
            for image in images {
                self.textures.entry(id).or_default().update(&image);
            }
        }
        for id in delta.free.drain() {
            self.textures.remove(&id);
        }
    }

    fn render(&mut self, ctx: &egui::Context, output: &egui::FullOutput) -> Result<RgbaImage, String> {
        let scale = output.pixels_per_point;
        let size = (ctx.content_rect().size() * scale).round();
        let background = ctx.style_of(ctx.theme()).visuals.panel_fill.to_opaque();
        let mut canvas = Canvas::new(size.x as usize, size.y as usize, background);
        for clipped in ctx.tessellate(output.shapes.clone(), scale) {
            let Primitive::Mesh(mesh) = &clipped.primitive else { continue };
            let texture = self.textures.get(&mesh.texture_id).ok_or("unknown texture")?;
            let clip = clipped.clip_rect * scale;
            let bound = |at: f32, max: usize| (at.round().max(0.0) as usize).min(max) as i64;
            canvas.clip = [
                bound(clip.min.x, canvas.width),
                bound(clip.max.x, canvas.width),
                bound(clip.min.y, canvas.height),
                bound(clip.max.y, canvas.height),
            ];
            canvas.mesh(mesh, texture, scale);
        }
        let bytes = canvas.pixels.iter().flat_map(egui::Color32::to_array).collect();
        RgbaImage::from_raw(canvas.width as u32, canvas.height as u32, bytes)
            .ok_or("image size mismatch".into())
    }
}

/// A texture.
#[derive(Default)]
struct Texture {
    size: [usize; 2],
    pixels: Vec<Color32>,
    nearest: bool,
}

impl Texture {
    fn update(&mut self, delta: &ImageDelta) {
        let ImageData::Color(image) = &delta.image;
        self.nearest = delta.options.magnification == TextureFilter::Nearest;
        let Some([x, y]) = delta.pos else {
            (self.size, self.pixels) = (image.size, image.pixels.clone());
            return;
        };
        for (row, part) in image.pixels.chunks_exact(image.size[0].max(1)).enumerate() {
            let start = (y + row) * self.size[0] + x;
            self.pixels[start..start + part.len()].copy_from_slice(part);
        }
    }

    fn texel(&self, x: i64, y: i64) -> [f32; 4] {
        let [width, height] = self.size.map(|n| n as i64);
        let at = y.clamp(0, height - 1) * width + x.clamp(0, width - 1);
        self.pixels[at as usize].to_array().map(f32::from)
    }

    /// The colour at (u, v), each 0 to 1; each channel 0 to 255.
    fn sample(&self, u: f32, v: f32) -> [f32; 4] {
        let (x, y) = (u * self.size[0] as f32, v * self.size[1] as f32);
        if self.nearest {
            return self.texel(x.floor() as i64, y.floor() as i64);
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (right_part, bottom_part) = (x - left, y - top);
        let (left, top) = (left as i64, top as i64);
        let across = |y| mix(self.texel(left, y), self.texel(left + 1, y), right_part);
        mix(across(top), across(top + 1), bottom_part)
    }
}

fn mix(a: [f32; 4], b: [f32; 4], part: f32) -> [f32; 4] {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * part)
}

/// A corner of a triangle: its position in 1/256 pixel, and its attributes red, green, blue, alpha, u, v.
#[derive(Clone, Copy)]
struct Corner {
    x: i64,
    y: i64,
    attributes: [f32; 6],
}

impl Corner {
    fn new(vertex: &Vertex, scale: f32) -> Self {
        let snap = |at: f32| (f64::from(at) * f64::from(scale) * SUB as f64).round() as i64;
        let [r, g, b, a] = vertex.color.to_array().map(f32::from);
        Self {
            x: snap(vertex.pos.x),
            y: snap(vertex.pos.y),
            attributes: [r, g, b, a, vertex.uv.x, vertex.uv.y],
        }
    }
}

/// Twice the signed area of the triangle (a, b, point): positive on the inner side of the edge.
fn side(a: &Corner, b: &Corner, x: i64, y: i64) -> i64 {
    (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)
}

struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<Color32>,
    /// First column, end of the columns, first row, end of the rows; the ends are exclusive.
    clip: [i64; 4],
}

impl Canvas {
    fn new(width: usize, height: usize, background: Color32) -> Self {
        Self { width, height, pixels: vec![background; width * height], clip: [0; 4] }
    }

    fn mesh(&mut self, mesh: &Mesh, texture: &Texture, scale: f32) {
        for triangle in mesh.indices.chunks_exact(3) {
            let vertices = [0, 1, 2].map(|k| &mesh.vertices[triangle[k] as usize]);
            let is_valid = |v: &&Vertex| v.pos.x.abs() < 1e6 && v.pos.y.abs() < 1e6;
            if texture.pixels.is_empty() || !vertices.iter().all(is_valid) {
                continue;
            }
            let [a, b, c] = vertices.map(|vertex| Corner::new(vertex, scale));
            match side(&a, &b, c.x, c.y) {
                0 => {}
                area if area > 0 => self.triangle([a, b, c], area, texture),
                area => self.triangle([a, c, b], -area, texture),
            }
        }
    }

    fn triangle(&mut self, corners: [Corner; 3], area: i64, texture: &Texture) {
        let [a, b, c] = &corners;
        let flat = a.attributes == b.attributes && b.attributes == c.attributes;
        let flat = flat.then(|| fragment(a.attributes, texture));
        let [from_x, to_x, from_y, to_y] = self.clip;
        let row_of = |y: i64| (y - SUB / 2).div_euclid(SUB);
        let (top, bottom) = (a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
        for row in from_y.max(row_of(top))..to_y.min(row_of(bottom) + 1) {
            let y = row * SUB + SUB / 2;
            let (mut from, mut to) = (from_x, to_x);
            for (p, q) in [(a, b), (b, c), (c, a)] {
                // A pixel on an edge belongs to the triangle only if it is a top or left edge.
                let owns = q.y < p.y || (q.y == p.y && q.x > p.x);
                let needs = i64::from(!owns);
                let at_first = side(p, q, SUB / 2, y);
                // In column n, `side` is `at_first - n * falls`; inside, it is at least `needs`.
                let falls = (q.y - p.y) * SUB;
                match falls {
                    0 if at_first < needs => to = from,
                    0 => {}
                    ..0 => from = from.max(-(at_first - needs).div_euclid(-falls)),
                    1.. => to = to.min((at_first - needs).div_euclid(falls) + 1),
                }
            }
            if from >= to {
                continue;
            }
            let start = row as usize * self.width;
            let span = &mut self.pixels[start + from as usize..start + to as usize];
            if let Some(colour) = flat {
                fill(span, colour);
                continue;
            }
            let x = from * SUB + SUB / 2;
            let parts = |p, q, x: i64| side(p, q, x, y) as f64 / area as f64;
            let at = |x: i64| -> [f64; 6] {
                let (of_b, of_c) = (parts(c, a, x), parts(a, b, x));
                std::array::from_fn(|k| {
                    let [a, b, c] = [a, b, c].map(|corner| f64::from(corner.attributes[k]));
                    a + of_b * (b - a) + of_c * (c - a)
                })
            };
            let (first, next) = (at(x), at(x + SUB));
            for (n, pixel) in span.iter_mut().enumerate() {
                let attributes = std::array::from_fn(|k| (first[k] + (next[k] - first[k]) * n as f64) as f32);
                blend(pixel, fragment(attributes, texture));
            }
        }
    }
}

/// The colour of a pixel with these attributes, each channel 0 to 255.
fn fragment(attributes: [f32; 6], texture: &Texture) -> [f32; 4] {
    let [.., u, v] = attributes;
    let sampled = texture.sample(u, v);
    std::array::from_fn(|k| attributes[k] * sampled[k] / 255.0)
}

fn fill(span: &mut [Color32], colour: [f32; 4]) {
    if colour[3] >= 255.0 {
        let mut solid = Color32::BLACK;
        blend(&mut solid, colour);
        span.fill(solid);
    } else {
        span.iter_mut().for_each(|pixel| blend(pixel, colour));
    }
}

/// Blends a premultiplied colour over a pixel.
fn blend(pixel: &mut Color32, colour: [f32; 4]) {
    let under = pixel.to_array();
    let transparency = 1.0 - colour[3] / 255.0;
    let [r, g, b, a] = std::array::from_fn(|k| (colour[k] + f32::from(under[k]) * transparency + 0.5) as u8);
    *pixel = Color32::from_rgba_premultiplied(r, g, b, a);
}
