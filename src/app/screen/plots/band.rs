//! The band: the area between the minimum and the maximum of each bucket of a series, as an item of an egui
//! plot. The series is borrowed, not copied.

use std::ops::RangeInclusive;
use std::sync::Arc;

use egui::{Color32, Mesh, Shape};
use egui_plot::{PlotBounds, PlotGeometry, PlotItem, PlotItemBase, PlotPoint, PlotTransform};

use crate::app::history::DownsampledSeries;

/// The area between the minima and the maxima of a series.
pub struct Band<'a> {
    series: &'a DownsampledSeries,
    color: Color32,
    base: PlotItemBase,
}

impl<'a> Band<'a> {
    /// The band of `series`, filled with `color`.
    #[must_use]
    pub fn new(series: &'a DownsampledSeries, color: Color32) -> Self {
        Self { series, color, base: PlotItemBase::new("band".into()) }
    }
}

impl PlotItem for Band<'_> {
    fn shapes(&self, _: &egui::Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        let mut mesh = Mesh::default();
        let points = self.series.points();
        mesh.reserve_vertices(2 * points.len());
        mesh.reserve_triangles(2 * points.len());
        for ((point, &low), &high) in points.iter().zip(self.series.lows()).zip(self.series.highs()) {
            let index = mesh.vertices.len() as u32;
            for value in [low, high] {
                let corner = transform.position_from_point(&PlotPoint::new(point.x, value));
                mesh.colored_vertex(corner, self.color);
            }
            if index >= 2 {
                mesh.add_triangle(index - 2, index - 1, index);
                mesh.add_triangle(index - 1, index, index + 1);
            }
        }
        shapes.push(Shape::Mesh(Arc::new(mesh)));
    }

    fn initialize(&mut self, _: RangeInclusive<f64>) {}

    fn color(&self) -> Color32 {
        self.color
    }

    fn allow_hover(&self) -> bool {
        false
    }

    fn geometry(&self) -> PlotGeometry<'_> {
        PlotGeometry::None
    }

    fn bounds(&self) -> PlotBounds {
        let mut bounds = PlotBounds::NOTHING;
        for point in [self.series.points().first(), self.series.points().last()].into_iter().flatten() {
            bounds.extend_with_x(point.x);
        }
        for &value in self.series.lows().iter().chain(self.series.highs()) {
            bounds.extend_with_y(value);
        }
        bounds
    }

    fn base(&self) -> &PlotItemBase {
        &self.base
    }

    fn base_mut(&mut self) -> &mut PlotItemBase {
        &mut self.base
    }
}
