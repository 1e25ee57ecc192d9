//! Scans from arbitrary poses in an arena, for displays such as the value map. Read-only.
//!
//! In: an arena's colliders at their current positions, and a pose. Out: the scan from that pose, without noise.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_rapier2d::prelude::RapierContextColliders;

use super::lidar::cast_in_arena;
use super::physics::Bodies;
use crate::task::{Arena, ArenaLayout, Pose, Scan};

/// Read access to the colliders of all arenas.
#[derive(SystemParam)]
pub struct Probe<'w, 's> {
    arenas: Query<
        'w,
        's,
        (&'static Arena, &'static ArenaLayout, &'static Bodies, &'static RapierContextColliders),
    >,
}

impl Probe<'_, '_> {
    /// A function that casts a scan from a pose in `arena` and writes its ranges, in m, into the given [`Scan`]. `None` if
    /// the arena does not exist.
    #[must_use]
    pub fn of(&self, arena: usize) -> Option<impl Fn(&Pose, &mut Scan) + '_> {
        let (_, layout, bodies, context) = self.arenas.iter().find(|(other, ..)| other.0 == arena)?;
        let max_range_m = layout.scenario.lidar.max_range_m;
        Some(move |pose: &Pose, scan: &mut Scan| {
            cast_in_arena(&context.colliders, bodies, pose, &layout.beams, max_range_m, &mut scan.ranges_m);
            scan.nearest_m = scan.ranges_m.iter().copied().fold(max_range_m, f32::min);
            scan.touching = false;
        })
    }
}
