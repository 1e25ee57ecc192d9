//! Gazebo worlds and models, in SDF.
//!
//! In: an SDF file, and folders with models. Out: the solids at the height of the LIDAR, and what is left out or changed.
//! Boxes, upright cylinders and capsules, and spheres are understood, in nested models and with nested poses that turn about
//! the vertical axis.

mod geometry;
mod models;
mod pose;
mod xml;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use roxmltree::Node;
use wayfield_scenario::limits::MAX_OBSTACLES;
use wayfield_scenario::{FileError, read_text_with_limit};

use crate::findings::Findings;
use crate::limits::{MAX_INCLUDES, MAX_MODEL_NESTING, MAX_WORLD_BYTES};
use crate::options::ImportOptions;
use crate::solid::Solid;
use geometry::Section;
use pose::Pose;
use xml::{XmlFile, children, name};

/// The solids of a world, and what was left out or changed.
#[derive(Debug, Default)]
pub struct SdfWorld {
    /// The solids at the height of the LIDAR.
    pub solids: Vec<Solid>,
    /// What was left out, or is not as in the file.
    pub findings: Findings,
    /// The imported file; included models are also searched for next to it.
    path: PathBuf,
    bytes_read: u64,
    includes: usize,
}

/// The finding about elements whose pose is relative to a frame other than that of their parent.
const OTHER_FRAME: &str = "poses relative to other frames are not understood, so these are left out";

/// How a model is placed by the world, model or include that contains it.
#[derive(Clone, Copy)]
struct Placement<'a> {
    /// The pose of the world or model around it.
    pose: Pose,
    /// The pose that replaces the model's own.
    own_pose: Option<Pose>,
    /// The name that replaces the model's own.
    name: Option<&'a str>,
    is_static: bool,
    /// The number of models around it. An included model counts once, as a model.
    depth: usize,
}

impl SdfWorld {
    /// The world or model in the file at `path`.
    ///
    /// # Errors
    /// The file is missing, is not SDF, is too large or has no shape that can be imported; or a number in it, or in a model
    /// that it includes, is invalid.
    pub fn read(path: &Path, options: &ImportOptions) -> Result<Self, FileError> {
        let text = read_text_with_limit(path, MAX_WORLD_BYTES)?;
        Self::parse(&text, path, options)
    }

    /// The world or model in `text`. Errors name `path`.
    ///
    /// # Errors
    /// As for [`SdfWorld::read`].
    pub fn parse(text: &str, path: &Path, options: &ImportOptions) -> Result<Self, FileError> {
        let mut world = Self { path: path.into(), ..Self::default() };
        let document = xml::parse(text, path)?;
        let file = XmlFile { path, text };
        let root = document.root_element();
        if root.tag_name().name() != "sdf" {
            return Err(file.error(
                root,
                "not an SDF file: the first element must be <sdf>; help: give a .world or .sdf file",
            ));
        }
        let top = Placement { pose: Pose::default(), own_pose: None, name: None, is_static: false, depth: 0 };
        match children(root, "world").next() {
            Some(found) => world.add_world(&file, found, top, options)?,
            None => world.add_models(&file, root, top, options)?,
        }
        if world.solids.is_empty() {
            let left_out = world.findings.lines().join("; ");
            let why = if left_out.is_empty() { "it has no collision shapes".into() } else { left_out };
            return Err(FileError::for_file(
                path,
                format!(
                    "nothing in it can be imported: {why}; help: give a world with boxes, cylinders or spheres"
                ),
            ));
        }
        Ok(world)
    }

    fn add_world(
        &mut self,
        file: &XmlFile<'_>,
        world: Node<'_, '_>,
        top: Placement<'_>,
        options: &ImportOptions,
    ) -> Result<(), FileError> {
        for element in world.children().filter(Node::is_element) {
            match element.tag_name().name() {
                "plugin" if is_simulators_own(plugin(element)) => {}
                "plugin" => self.findings.add("plugins do not run", plugin(element)),
                "actor" => self.findings.add("actors are left out", name(element)),
                kind @ ("population" | "road") => self.findings.add("other parts are left out", kind),
                _ => {}
            }
        }
        self.add_models(file, world, top, options)
    }

    /// Adds the models in `parent`, a world or a model.
    fn add_models(
        &mut self,
        file: &XmlFile<'_>,
        parent: Node<'_, '_>,
        at: Placement<'_>,
        options: &ImportOptions,
    ) -> Result<(), FileError> {
        let saved = saved_poses(parent);
        for include in children(parent, "include") {
            self.include(file, include, at, &saved, options)?;
        }
        for model in children(parent, "model") {
            let own_pose = match saved.get(name(model)) {
                Some(&node) => {
                    let Some(pose) = pose::read(file, node)? else {
                        self.findings.add(OTHER_FRAME, name(model));
                        continue;
                    };
                    Some(pose)
                }
                None => None,
            };
            self.add_model(file, model, Placement { own_pose, name: None, ..at }, options)?;
        }
        Ok(())
    }

    fn add_model(
        &mut self,
        file: &XmlFile<'_>,
        model: Node<'_, '_>,
        at: Placement<'_>,
        options: &ImportOptions,
    ) -> Result<(), FileError> {
        let label = at.name.unwrap_or_else(|| name(model));
        check_nesting(file, model, at.depth)?;
        let moves = |joint: Node<'_, '_>| joint.attribute("type").is_none_or(|kind| kind != "fixed");
        if children(model, "joint").any(moves) {
            self.findings.add("models with joints, such as robots, are left out", label);
            return Ok(());
        }
        for found in children(model, "plugin") {
            self.findings.add("plugins do not run", plugin(found));
        }
        let Some(own) = at.own_pose.map_or_else(|| pose::of(file, model), |pose| Ok(Some(pose)))? else {
            self.findings.add(OTHER_FRAME, label);
            return Ok(());
        };
        let is_static = at.is_static
            || children(model, "static").next().is_some_and(|node| xml::is_true(xml::text(node)));
        let before = self.solids.len();
        let here =
            Placement { pose: at.pose.then(own), own_pose: None, name: None, is_static, depth: at.depth + 1 };
        for link in children(model, "link") {
            self.add_link(file, link, label, here.pose, options)?;
        }
        self.add_models(file, model, here, options)?;
        if !is_static && self.solids.len() > before {
            self.findings.add("models that could be pushed stand still", label);
        }
        Ok(())
    }

    fn add_link(
        &mut self,
        file: &XmlFile<'_>,
        link: Node<'_, '_>,
        model: &str,
        at: Pose,
        options: &ImportOptions,
    ) -> Result<(), FileError> {
        let own = pose::of(file, link)?;
        for collision in children(link, "collision") {
            let label = format!("{model}/{}", name(collision));
            let (Some(own), Some(inner)) = (own, pose::of(file, collision)?) else {
                self.findings.add(OTHER_FRAME, &label);
                continue;
            };
            let Some(shape) = children(collision, "geometry").next() else { continue };
            match geometry::section(file, shape, at.then(own).then(inner), options.lidar_height_m)? {
                Section::Solid(solid) => self.solids.push(solid),
                Section::Floor => {}
                Section::LeftOut(why) => self.findings.add(&why, &label),
            }
            if self.solids.len() > MAX_OBSTACLES {
                return Err(
                    file.error(collision, format!("more than {MAX_OBSTACLES} shapes; help: remove some"))
                );
            }
        }
        Ok(())
    }

    /// Adds the model that `include` names. For `saved` see [`saved_poses`].
    fn include(
        &mut self,
        file: &XmlFile<'_>,
        include: Node<'_, '_>,
        at: Placement<'_>,
        saved: &BTreeMap<&str, Node<'_, '_>>,
        options: &ImportOptions,
    ) -> Result<(), FileError> {
        let uri = children(include, "uri").next().map_or("", xml::text);
        if models::is_scenery(uri) {
            return Ok(());
        }
        for found in children(include, "plugin") {
            self.findings.add("plugins do not run", plugin(found));
        }
        let Some(path) = models::find(uri, [file.path, &self.path], &options.models) else {
            self.findings
                .add("models that were not found are left out (name their folder with --models)", uri);
            return Ok(());
        };
        self.includes += 1;
        if self.includes > MAX_INCLUDES {
            let message = format!("more than {MAX_INCLUDES} models are included; help: remove some");
            return Err(file.error(include, message));
        }
        check_nesting(file, include, at.depth)?;
        let text = read_text_with_limit(&path, MAX_WORLD_BYTES)?;
        self.bytes_read += text.len() as u64;
        if self.bytes_read > MAX_WORLD_BYTES {
            let most = MAX_WORLD_BYTES >> 20;
            let message =
                format!("the included models are larger than {most} MiB together; help: remove some");
            return Err(file.error(include, message));
        }
        let document = xml::parse(&text, &path)?;
        let is_static = children(include, "static").next().is_some_and(|node| xml::is_true(xml::text(node)));
        let inside = XmlFile { path: &path, text: &text };
        let Some(model) = children(document.root_element(), "model").next() else {
            self.findings.add("included files without a model are left out", uri);
            return Ok(());
        };
        let label = children(include, "name").next().map(xml::text);
        let saved_pose = saved.get(label.unwrap_or_else(|| name(model))).copied();
        let pose_node = saved_pose.or_else(|| children(include, "pose").next());
        let own_pose = pose_node.map_or(Ok(None), |node| pose::read(file, node))?;
        if pose_node.is_some() && own_pose.is_none() {
            self.findings.add(OTHER_FRAME, label.unwrap_or(uri));
            return Ok(());
        }
        let is_static = at.is_static || is_static;
        let placement = Placement { own_pose, name: label, is_static, ..at };
        self.add_model(&inside, model, placement, options)
    }
}

/// Checks that at most [`MAX_MODEL_NESTING`] models are around `element`, a model or an include.
fn check_nesting(file: &XmlFile<'_>, element: Node<'_, '_>, depth: usize) -> Result<(), FileError> {
    if depth <= MAX_MODEL_NESTING {
        return Ok(());
    }
    let message = format!(
        "models and included models are nested more than {MAX_MODEL_NESTING} deep; help: flatten them"
    );
    Err(file.error(element, message))
}

/// The poses in the saved state of a world, by model name. They replace those of the models and includes.
fn saved_poses<'a, 'input>(world: Node<'a, 'input>) -> BTreeMap<&'a str, Node<'a, 'input>> {
    let models = children(world, "state").take(1).flat_map(|state| children(state, "model"));
    models.filter_map(|model| Some((name(model), children(model, "pose").next()?))).collect()
}

/// Whether a plugin is a part of Gazebo itself, such as its physics.
fn is_simulators_own(plugin: &str) -> bool {
    ["gz-sim-", "ignition-gazebo-", "libignition-gazebo"].iter().any(|start| plugin.starts_with(start))
}

/// The name of a plugin for messages.
fn plugin<'a>(node: Node<'a, '_>) -> &'a str {
    node.attribute("filename").or_else(|| node.attribute("name")).unwrap_or("unnamed")
}
