//! The transform between an arena, in m with y up, and the screen, in points with y down.
//!
//! In: the rectangle of a view, the camera, the bounds of the arena. Out: a [`ViewTransform`], and the camera
//! after a pan or a zoom.

use egui::{Pos2, Rect, Vec2, pos2, vec2};

use crate::app::view_state::ViewCamera;
use crate::scenario::Enclosure;

/// The smallest and the largest zoom.
const ZOOM: (f32, f32) = (0.5, 40.0);

/// An axis-aligned box in an arena.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArenaBounds {
    /// The lower left corner, in m.
    pub min_m: [f32; 2],
    /// The upper right corner, in m.
    pub max_m: [f32; 2],
}

impl ArenaBounds {
    /// The bounding box of `enclosure`; a box of 2 m by 2 m if a corner is not finite or beyond 1000 km.
    #[must_use]
    pub fn from_enclosure(enclosure: &Enclosure) -> Self {
        let (min, max) = enclosure.bounds_m();
        let [min_m, max_m]: [[f32; 2]; 2] = [min.into(), max.into()];
        if min_m.into_iter().chain(max_m).all(|at| at.abs() < 1e6) {
            Self { min_m, max_m }
        } else {
            Self { min_m: [-1.0; 2], max_m: [1.0; 2] }
        }
    }

    /// Width and height, in m.
    #[must_use]
    pub fn size_m(&self) -> [f32; 2] {
        [0, 1].map(|k| (self.max_m[k] - self.min_m[k]).max(1e-3))
    }

    /// The centre, in m.
    #[must_use]
    pub fn centre_m(&self) -> [f32; 2] {
        [0, 1].map(|k| (self.min_m[k] + self.max_m[k]) / 2.0)
    }

    /// The nearest point inside the box; both points are relative to its centre.
    fn clamp(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        let [width_m, height_m] = self.size_m();
        [x.clamp(-width_m / 2.0, width_m / 2.0), y.clamp(-height_m / 2.0, height_m / 2.0)]
    }
}

/// The transform between an arena and one view of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewTransform {
    /// The view on the screen, in points.
    pub rect: Rect,
    /// Points per metre.
    pub scale: f32,
    /// The point at the centre of the view, in m.
    pub centre_m: [f32; 2],
    bounds: ArenaBounds,
    margin: Vec2,
}

impl ViewTransform {
    /// The view `rect` through `camera`. At zoom 1 it shows all of `bounds`, with `margin` points on each
    /// side.
    #[must_use]
    pub fn new(rect: Rect, margin: Vec2, camera: ViewCamera, bounds: ArenaBounds) -> Self {
        let [width_m, height_m] = bounds.size_m();
        let available = (rect.size() - 2.0 * margin).max(Vec2::splat(1.0));
        let fit = (available.x / width_m).min(available.y / height_m);
        let ([mx, my], [x, y]) = (bounds.centre_m(), camera.centre_m);
        let scale = fit * camera.zoom.clamp(ZOOM.0, ZOOM.1);
        Self { rect, scale, centre_m: [mx + x, my + y], bounds, margin }
    }

    /// This view with another camera.
    #[must_use]
    pub fn with_camera(&self, camera: ViewCamera) -> Self {
        Self::new(self.rect, self.margin, camera, self.bounds)
    }

    /// The screen position of a point in m.
    #[must_use]
    pub fn to_screen(self, [x_m, y_m]: [f32; 2]) -> Pos2 {
        let [cx, cy] = self.centre_m;
        self.rect.center() + vec2(x_m - cx, cy - y_m) * self.scale
    }

    /// The point in m at a screen position.
    #[must_use]
    pub fn to_world(self, at: Pos2) -> [f32; 2] {
        let away = (at - self.rect.center()) / self.scale;
        [self.centre_m[0] + away.x, self.centre_m[1] - away.y]
    }

    /// A length in m, converted to points.
    #[must_use]
    pub fn to_screen_length(self, metres: f32) -> f32 {
        metres * self.scale
    }

    /// The screen rectangle between two corners in m.
    #[must_use]
    pub fn to_screen_rect(self, min_m: [f32; 2], max_m: [f32; 2]) -> Rect {
        Rect::from_two_pos(self.to_screen(min_m), self.to_screen(max_m))
    }

    /// The screen rectangle of the bounds.
    #[must_use]
    pub fn bounds_rect(&self) -> Rect {
        self.to_screen_rect(self.bounds.min_m, self.bounds.max_m)
    }

    /// The camera after the view was dragged by `delta` points. The centre of the view stays inside the
    /// bounds.
    #[must_use]
    pub fn panned(&self, camera: ViewCamera, delta: Vec2) -> ViewCamera {
        let [x, y] = camera.centre_m;
        let by = delta / self.scale;
        ViewCamera { centre_m: self.bounds.clamp([x - by.x, y + by.y]), ..camera }
    }

    /// The camera zoomed in by `factor`. The point under the screen position `about` stays there, unless the centre of the view
    /// would leave the bounds.
    #[must_use]
    pub fn zoomed(&self, camera: ViewCamera, about: Pos2, factor: f32) -> ViewCamera {
        let zoom = (camera.zoom * factor).clamp(ZOOM.0, ZOOM.1);
        let ([wx, wy], [mx, my]) = (self.to_world(about), self.bounds.centre_m());
        let (wx, wy, keep) = (wx - mx, wy - my, camera.zoom / zoom);
        let [x, y] = camera.centre_m;
        ViewCamera { centre_m: self.bounds.clamp([wx + (x - wx) * keep, wy + (y - wy) * keep]), zoom }
    }
}

/// The screen unit vector (y down) of a direction in rad, counterclockwise from +x.
#[must_use]
pub fn screen_direction(angle_rad: f32) -> Vec2 {
    let (sin, cos) = angle_rad.sin_cos();
    vec2(cos, -sin)
}

/// `rect` moved into `bounds`, as far as it fits.
#[must_use]
pub fn constrain_to(rect: Rect, bounds: Rect) -> Rect {
    let high = (bounds.max - rect.size()).max(bounds.min);
    let min = rect.min.clamp(bounds.min, high);
    Rect::from_min_size(pos2(min.x, min.y), rect.size())
}

#[cfg(test)]
mod tests {
    use bevy::math;

    use super::*;

    const WALLS: ArenaBounds = ArenaBounds { min_m: [-2.0, -1.0], max_m: [2.0, 1.0] };

    const MARGIN: Vec2 = vec2(10.0, 10.0);

    fn view() -> Rect {
        Rect::from_min_size(pos2(100.0, 50.0), vec2(820.0, 620.0))
    }

    #[test]
    fn the_enclosure_fits_the_view_and_y_points_up() {
        let transform = ViewTransform::new(view(), MARGIN, ViewCamera::default(), WALLS);
        assert_eq!(transform.scale, 200.0);
        assert_eq!(transform.bounds_rect(), Rect::from_min_max(pos2(110.0, 160.0), pos2(910.0, 560.0)));
        assert!(transform.to_screen([0.0, 1.0]).y < transform.to_screen([0.0, 0.0]).y);
        assert!((screen_direction(std::f32::consts::FRAC_PI_2) - vec2(0.0, -1.0)).length() < 1e-6);
    }

    #[test]
    fn to_screen_and_to_world_are_inverse() {
        let camera = ViewCamera { centre_m: [0.7, -0.4], zoom: 3.5 };
        let transform = ViewTransform::new(view(), MARGIN, camera, WALLS);
        for point in [[0.0, 0.0], [1.9, -0.9], [-2.0, 1.0], [0.7, -0.4]] {
            let back = transform.to_world(transform.to_screen(point));
            assert!((back[0] - point[0]).abs() < 1e-5 && (back[1] - point[1]).abs() < 1e-5, "{back:?}");
        }
        assert_eq!(transform.to_screen([0.7, -0.4]), view().center());
    }

    #[test]
    fn zooming_keeps_the_point_under_the_pointer_and_panning_follows_it() {
        let camera = ViewCamera { centre_m: [0.2, 0.1], zoom: 1.5 };
        let transform = ViewTransform::new(view(), MARGIN, camera, WALLS);
        let pointer = pos2(430.0, 300.0);
        let point = transform.to_world(pointer);
        let nearer = ViewTransform::new(view(), MARGIN, transform.zoomed(camera, pointer, 1.7), WALLS);
        assert!((nearer.to_screen(point) - pointer).length() < 0.01);
        let panned = ViewTransform::new(view(), MARGIN, transform.panned(camera, vec2(30.0, -20.0)), WALLS);
        assert!((panned.to_screen(point) - pointer - vec2(30.0, -20.0)).length() < 0.01);
    }

    #[test]
    fn an_enclosure_off_the_origin_is_centred_in_its_view() {
        let corners_m = vec![math::vec2(10.0, 5.0), math::vec2(14.0, 5.0), math::vec2(10.0, 7.0)];
        let bounds = ArenaBounds::from_enclosure(&Enclosure::Polygon { corners_m });
        assert_eq!((bounds.size_m(), bounds.centre_m()), ([4.0, 2.0], [12.0, 6.0]));
        let transform = ViewTransform::new(view(), MARGIN, ViewCamera::default(), bounds);
        assert_eq!((transform.to_screen([12.0, 6.0]), transform.scale), (view().center(), 200.0));
        let pointer = pos2(430.0, 300.0);
        let point = transform.to_world(pointer);
        let nearer =
            ViewTransform::new(view(), MARGIN, transform.zoomed(ViewCamera::default(), pointer, 2.0), bounds);
        assert!((nearer.to_screen(point) - pointer).length() < 0.01);
    }

    #[test]
    fn the_camera_stays_within_its_limits() {
        let transform = ViewTransform::new(view(), MARGIN, ViewCamera::default(), WALLS);
        let far = transform.panned(ViewCamera::default(), vec2(-1e6, 1e6));
        assert_eq!(far.centre_m, [2.0, 1.0]);
        assert_eq!(transform.zoomed(ViewCamera::default(), view().center(), 1e9).zoom, 40.0);
    }

    #[test]
    fn a_rectangle_outside_the_view_is_moved_into_it() {
        let bounds = Rect::from_min_max(pos2(0.0, 0.0), pos2(100.0, 100.0));
        let card = Rect::from_min_size(pos2(90.0, -5.0), vec2(20.0, 10.0));
        assert_eq!(constrain_to(card, bounds).min, pos2(80.0, 0.0));
    }
}
