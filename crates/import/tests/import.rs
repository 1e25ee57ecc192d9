//! Imports of maps and worlds written by hand: the scenarios that they become, and the messages for invalid ones.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;
use wayfield_import::{Frame, ImportOptions, Imported, backdrop, import, import_worlds};
use wayfield_scenario::{
    KeyFrame, KeyFrameEnd, ObstacleMotion, Scenario, Shape, Vec2, clearance, diagnostics, pose_at, vec2,
};

/// A folder with files. It is deleted on drop.
struct Folder(TempDir);

impl Folder {
    fn new(files: &[(&str, &[u8])]) -> Self {
        let folder = Self(tempfile::tempdir().expect("a folder"));
        files.iter().for_each(|(name, contents)| folder.write(name, contents));
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, contents: &[u8]) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().expect("a parent")).expect("a folder");
        fs::write(path, contents).expect("a file");
    }

    fn import(&self, name: &str) -> Result<Imported, String> {
        self.import_with(name, &ImportOptions::default())
    }

    /// The result, or the message without the folder's path.
    fn import_with(&self, name: &str, options: &ImportOptions) -> Result<Imported, String> {
        let folder = format!("{}/", self.0.path().display());
        let result =
            import(&self.path(name), options).map_err(|error| error.to_string().replace(&folder, ""));
        if let Ok(imported) = &result {
            assert_eq!(diagnostics(&imported.scenario), [], "the scenario is valid");
            let again = Scenario::parse(&imported.text(), "again.ron").expect("the text is a scenario");
            assert_eq!(again, imported.scenario, "the text has the same contents");
        }
        result
    }
}

/// A PGM file in which 0 is black and 255 white.
fn pgm(width: usize, height: usize, value: impl Fn(usize, usize) -> u8) -> Vec<u8> {
    let mut bytes = format!("P5\n# by hand\n{width} {height}\n255\n").into_bytes();
    bytes.extend(
        (0..height).flat_map(|row| (0..width).map(move |column| (column, row))).map(|(c, r)| value(c, r)),
    );
    bytes
}

const YAML: &str = "image: map.pgm\nresolution: 0.05\norigin: [-3.0, -2.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

/// Positions of round pillars in the hand-made hall, in its own frame, whose origin is the hall's middle.
const PILLARS: [(f64, f64); 3] = [(-1.0, 0.5), (1.0, 0.5), (0.4, -0.8)];

/// A map of 6 m x 4 m: a hall of 5 m x 3 m with walls of 0.2 m and round pillars of radius 0.2 m, surrounded by grey, unknown
/// cells. The top row of the image comes first.
fn hall() -> Vec<u8> {
    pgm(120, 80, |column, row| {
        let (x, y) = (column as f64 * 0.05 + 0.025 - 3.0, 2.0 - (row as f64 * 0.05 + 0.025));
        let is_pillar = PILLARS.iter().any(|pillar| (x - pillar.0).hypot(y - pillar.1) < 0.2);
        let (beyond_x, beyond_y) = (x.abs() - 2.5, y.abs() - 1.5);
        let beyond = beyond_x.max(beyond_y);
        if is_pillar || (0.0..0.2).contains(&beyond) {
            0
        } else if beyond < 0.0 {
            254
        } else {
            205
        }
    })
}

/// The same hall as a Gazebo world.
fn hall_world() -> String {
    let mut models = String::new();
    for (k, (x, y, width, height)) in
        [(0.0, 1.6, 5.4, 0.2), (0.0, -1.6, 5.4, 0.2), (2.6, 0.0, 0.2, 3.4), (-2.6, 0.0, 0.2, 3.4)]
            .iter()
            .enumerate()
    {
        let _ = write!(
            models,
            "<link name='wall{k}'><pose>{x} {y} 0.5 0 0 0</pose><collision name='c'><geometry><box><size>{width} {height} 1</size></box></geometry></collision></link>"
        );
    }
    let mut pillars = String::new();
    for (k, (x, y)) in PILLARS.iter().enumerate() {
        let _ = write!(
            pillars,
            "<model name='pillar{k}'><static>true</static><pose>{x} {y} 0 0 0 0</pose><link name='l'><pose>0 0 0.5 0 0 1</pose><collision name='c'><geometry><cylinder><radius>0.2</radius><length>1</length></cylinder></geometry></collision></link></model>"
        );
    }
    format!(
        "<?xml version='1.0'?>\n<sdf version='1.6'><world name='hall'>\n<include><uri>model://ground_plane</uri></include>\n<model name='walls'><static>1</static>{models}</model>\n{pillars}</world></sdf>\n"
    )
}

/// The clearance at a point of the source's frame, in m; negative inside a solid or outside the enclosure.
fn distance(imported: &Imported, x: f64, y: f64) -> f32 {
    let frame = Frame::find(&imported.scenario.about).expect("the `about` states the frame");
    let at = frame.to_scenario([x, y].into());
    clearance(&imported.scenario, vec2(at.x as f32, at.y as f32), 0)
}

#[test]
fn a_map_and_a_world_of_the_same_hall_agree_within_a_cell() {
    let folder = Folder::new(&[
        ("map.yaml", YAML.as_bytes()),
        ("map.pgm", &hall()),
        ("hall.world", hall_world().as_bytes()),
    ]);
    let (map, world) =
        (folder.import("map.yaml").expect("a map"), folder.import("hall.world").expect("a world"));
    let every_cell = ImportOptions { tolerance_m: Some(0.0), ..ImportOptions::default() };
    let cells = folder.import_with("map.yaml", &every_cell).expect("a map");
    assert!(map.deviation_m <= 0.06 && cells.deviation_m == 0.0 && world.deviation_m == 0.0);
    assert_eq!(world.scenario.obstacles.len(), 7, "every shape is imported: {:?}", world.scenario.obstacles);
    let mut compared = 0;
    for step_x in -24..=24 {
        for step_y in -14..=14 {
            let (x, y) = (f64::from(step_x) * 0.1, f64::from(step_y) * 0.1);
            let exact = distance(&world, x, y);
            if exact > 0.1 {
                let tolerance_m = 0.06 + 0.036;
                assert!(
                    (distance(&map, x, y) - exact).abs() <= tolerance_m,
                    "({x}, {y}): {} and {exact}",
                    distance(&map, x, y)
                );
                assert!((distance(&cells, x, y) - exact).abs() <= 0.05, "({x}, {y}): cells");
                compared += 1;
            }
        }
    }
    assert!(compared > 1000, "{compared} points");
    for (x, y) in PILLARS {
        assert!(distance(&map, x, y) < -0.1 && distance(&world, x, y) < -0.19, "the pillars are solid");
    }
}

#[test]
fn a_desk_with_sides_along_x_and_y_becomes_a_rectangle() {
    // A hall of 5 m x 3 m, and a desk of 1 m x 0.5 m in it.
    let hall = pgm(120, 80, |column, row| {
        let is_wall = !(10..110).contains(&column) || !(10..70).contains(&row);
        let is_desk = (60..80).contains(&column) && (30..40).contains(&row);
        if is_wall || is_desk { 0 } else { 254 }
    });
    let map = Folder::new(&[("map.yaml", YAML.as_bytes()), ("map.pgm", &hall)]).import("map.yaml");
    let desks = map.expect("a map").scenario.obstacles;
    assert_eq!(desks.len(), 1, "{desks:?}");
    assert_eq!(desks[0].shape, Shape::Rectangle { width_m: 1.0, height_m: 0.5 });
    assert_eq!(desks[0].position_m, vec2(0.5, 0.25));
}

#[test]
fn simplified_walls_are_few_and_the_about_states_their_deviation() {
    let folder = Folder::new(&[("map.yaml", YAML.as_bytes()), ("map.pgm", &hall())]);
    let imported = folder.import("map.yaml").expect("a map");
    let stated = format!("walls deviate from them by at most {:.3} m", imported.deviation_m);
    let map = imported.scenario;
    let pieces = map.obstacles.len() + map.walls.iter().map(|wall| wall.corners_m.len()).sum::<usize>();
    assert!(pieces <= 3, "a pillar is one obstacle, and the hall is the enclosure: {map:?}");
    assert!(map.about.contains(&stated), "{}", map.about);
    assert!(map.benchmark_route.is_some());
    let every_cell = ImportOptions { tolerance_m: Some(0.0), ..ImportOptions::default() };
    let cells = folder.import_with("map.yaml", &every_cell).expect("a map").scenario;
    assert!(cells.walls.is_empty() && cells.obstacles.len() > 10);
}

#[test]
fn the_mode_the_thresholds_and_negate_decide_what_is_floor() {
    let width_m = |yaml: &str, image: &[u8]| {
        let folder = Folder::new(&[("map.yaml", yaml.as_bytes()), ("map.pgm", image)]);
        let (low, high) = folder.import("map.yaml").expect("a map").scenario.enclosure.bounds_m();
        high.x - low.x
    };
    assert!((width_m(YAML, &hall()) - 5.0).abs() < 1e-4);
    // With a higher `free_thresh`, unknown cells, which are grey, are free: here, all those around a black block.
    let unknown_is_free = YAML.replace("0.196", "0.25");
    let island = pgm(120, 80, |c, r| if (30..50).contains(&c) && (30..50).contains(&r) { 0 } else { 205 });
    assert!((width_m(&unknown_is_free, &island) - 6.0).abs() < 1e-4);
    let negated: Vec<u8> =
        pgm(120, 80, |c, r| if (10..110).contains(&c) && (10..70).contains(&r) { 0 } else { 255 });
    assert!((width_m(&YAML.replace("negate: 0", "negate: 1"), &negated) - 5.0).abs() < 1e-4);
    let raw = pgm(120, 80, |c, r| if (10..110).contains(&c) && (10..70).contains(&r) { 0 } else { 100 });
    assert!((width_m(&format!("{YAML}mode: raw\n"), &raw) - 5.0).abs() < 1e-4);
    let scale = pgm(120, 80, |c, r| if (10..110).contains(&c) && (10..70).contains(&r) { 240 } else { 150 });
    assert!((width_m(&format!("{YAML}mode: scale\n"), &scale) - 5.0).abs() < 1e-4);
}

#[test]
fn specks_and_unreachable_rooms_are_dropped() {
    let image = pgm(120, 80, |column, row| {
        let is_speck = column % 20 == 10 && row % 20 == 10 && column < 80;
        let is_frame = column == 0 || row == 0 || column == 119 || row == 79;
        // A room at the right that has no door.
        if is_speck || is_frame || column == 90 { 0 } else { 254 }
    });
    let folder = Folder::new(&[("map.yaml", YAML.as_bytes()), ("map.pgm", &image)]);
    let all = folder.import("map.yaml").expect("a map").scenario;
    let (low, high) = all.enclosure.bounds_m();
    assert!((high - low - vec2(89.0 * 0.05, 78.0 * 0.05)).length() < 1e-4, "the other room is left out");
    assert_eq!(all.obstacles.len() + all.walls.len(), 16, "each speck stays");
    let options = ImportOptions { speck_cells: 1, ..ImportOptions::default() };
    let clean = folder.import_with("map.yaml", &options).expect("a map").scenario;
    assert_eq!(clean.obstacles.len() + clean.walls.len(), 0);
    assert!(clean.about.contains("16 specks became floor."), "{}", clean.about);
}

#[test]
fn the_about_states_the_frame_of_a_map_whose_origin_has_a_yaw() {
    let yaml = YAML.replace("[-3.0, -2.0, 0.0]", "[2.0, 3.0, 1.0]");
    let folder = Folder::new(&[("map.yaml", yaml.as_bytes()), ("map.pgm", &hall())]);
    let imported = folder.import("map.yaml").expect("a map");
    // The pillar (-1, 0.5) is 2 m and 2.5 m from the lower left corner of the image.
    let (sin, cos) = 1_f64.sin_cos();
    let pillar = (2.0 + 2.0 * cos - 2.5 * sin, 3.0 + 2.0 * sin + 2.5 * cos);
    assert!(distance(&imported, pillar.0, pillar.1) < -0.1);
}

#[test]
fn a_plain_image_needs_a_scale() {
    let folder = Folder::new(&[("plan.pgm", &hall())]);
    let error = folder.import("plan.pgm").expect_err("no scale");
    assert_eq!(
        error,
        "plan.pgm: an image has no scale; help: give the side of a pixel in m, such as --resolution 0.05"
    );
    let options = ImportOptions { resolution_m: Some(0.1), ..ImportOptions::default() };
    let (low, high) = folder.import_with("plan.pgm", &options).expect("a plan").scenario.enclosure.bounds_m();
    // The unknown grey is bright, so the outside is floor, too; the hall is imported because it is larger.
    assert!((high - low - vec2(10.0, 6.0)).length() < 1e-4, "{low} {high}");
    let options = ImportOptions { resolution_m: Some(20.0), ..ImportOptions::default() };
    let error = backdrop(&folder.path("plan.pgm"), &options).expect_err("out of range").to_string();
    assert!(error.ends_with("plan.pgm: the resolution is 20; help: give 0.001 to 10 (metres)"), "{error}");
}

/// An SDF world with the elements `inside`.
fn world(inside: &str) -> String {
    format!("<sdf version='1.6'>\n<world name='w'>\n{inside}\n</world>\n</sdf>\n")
}

fn model(name: &str, more: &str, geometry: &str) -> String {
    format!(
        "<model name='{name}'><static>1</static>{more}<link name='l'><pose>0 0 0.5 0 0 0</pose><collision name='c'><geometry>{geometry}</geometry></collision></link></model>"
    )
}

const BOX: &str = "<box><size>2 0.5 1</size></box>";

#[test]
fn nested_poses_turn_and_move_their_shapes() {
    let inner = "<model name='inner'><static>1</static><pose>2 0 0 0 0 0.5</pose><link name='l'><pose>1 0 0 0 0 0</pose><collision name='c'><pose>0 1 0.5 0 0 0</pose><geometry><box><size>2 0.5 1</size></box></geometry></collision></link></model>";
    let outer = format!("<model name='outer'><static>1</static><pose>1 1 0 0 0 1.0</pose>{inner}</model>");
    let folder = Folder::new(&[("w.world", world(&outer).as_bytes())]);
    let imported = folder.import("w.world").expect("a world");
    // By hand: outer, then inner, then (1, 1) of link and collision.
    let (a, b) = ((1.0_f64.sin_cos()), (1.5_f64.sin_cos()));
    let at = (1.0 + 2.0 * a.1 + b.1 - b.0, 1.0 + 2.0 * a.0 + b.0 + b.1);
    assert!((distance(&imported, at.0, at.1) + 0.25).abs() < 1e-3);
    assert!((imported.scenario.obstacles[0].rotation_rad - 1.5).abs() < 1e-5);
}

#[test]
fn booleans_are_1_or_true_in_any_case() {
    for yes in ["1", "true", "True"] {
        let pose = format!("<pose degrees='{yes}'>0 0 0 0 0 30</pose>");
        let text = world(&model("m", &pose, BOX)).replace("<static>1<", &format!("<static>{yes}<"));
        let folder = Folder::new(&[("w.world", text.as_bytes())]);
        let imported = folder.import("w.world").expect("a world");
        let rotation_rad = imported.scenario.obstacles[0].rotation_rad;
        assert!((rotation_rad - 30_f32.to_radians()).abs() < 1e-5, "{yes}: {rotation_rad}");
        assert_eq!(imported.findings, [""; 0], "{yes}");
    }
}

#[test]
fn comments_in_front_of_values_are_skipped() {
    let pose = "<pose>\n<!-- x y z roll pitch yaw -->\n1 2 0 0 0 0.5\n</pose>";
    let text = world(&model("m", pose, BOX)).replace("<static>1<", "<static><!-- fixed -->1<");
    let folder = Folder::new(&[("w.world", text.as_bytes())]);
    let imported = folder.import("w.world").expect("a world");
    assert!((distance(&imported, 1.0, 2.0) + 0.25).abs() < 1e-3);
    assert!((imported.scenario.obstacles[0].rotation_rad - 0.5).abs() < 1e-5);
    assert_eq!(imported.findings, [""; 0]);
}

#[test]
fn ground_and_light_are_no_models_that_were_not_found() {
    let folder = Folder::new(&[]);
    for (uri, is_scenery) in [
        ("model://sun", true),
        ("model://sun/", true),
        ("model://ground_plane/2", true),
        ("https://fuel.gazebosim.org/1.0/OpenRobotics/models/Sun/tip", true),
        ("https://fuel.gazebosim.org/1.0/OpenRobotics/models/Ground Plane/1/", true),
        ("model://sun/table", false),
        ("model://2", false),
    ] {
        let inside = format!("<include><uri>{uri}</uri></include>{}", model("m", "", BOX));
        folder.write("w.world", world(&inside).as_bytes());
        let findings = folder.import("w.world").expect("a world").findings;
        assert_eq!(findings.is_empty(), is_scenery, "{uri}: {findings:?}");
    }
}

#[test]
fn included_models_are_found_and_their_pose_is_replaced() {
    let table = format!("<sdf version='1.6'>{}</sdf>", model("table", "<pose>50 50 0 0 0 0</pose>", BOX));
    let include = "<include><uri>model://table</uri><pose>1 2 0 0 0 0</pose></include>";
    let files = [("w.world", world(include)), ("lib/table/model.sdf", table)];
    let files = files.each_ref().map(|(name, text)| (*name, text.as_bytes()));
    let folder = Folder::new(&files);
    let error = folder.import("w.world").expect_err("the model is elsewhere");
    assert!(
        error.starts_with("w.world: nothing in it can be imported: models that were not found are left out"),
        "{error}"
    );
    let options = ImportOptions { models: vec![folder.path("lib")], ..ImportOptions::default() };
    let imported = folder.import_with("w.world", &options).expect("a world");
    assert!((distance(&imported, 1.0, 2.0) + 0.25).abs() < 1e-3);
    // There is a model at each of these places, but none is a folder inside `lib`.
    folder.write("lib/model.sdf", files[1].1);
    let absolute = format!("model://{}", folder.path("lib/table").display());
    for uri in ["model://../lib/table", absolute.as_str(), "model://", ""] {
        folder.write("w.world", world(&format!("<include><uri>{uri}</uri></include>")).as_bytes());
        assert!(folder.import_with("w.world", &options).is_err(), "`{uri}` was imported");
    }
    let itself = format!(
        "<sdf version='1.6'><model name='m'><static>1</static>{include}{}</model></sdf>",
        "<link name='l'/>"
    );
    folder.write("lib/table/model.sdf", itself.as_bytes());
    folder.write("w.world", world(include).as_bytes());
    let error = folder.import_with("w.world", &options).expect_err("it includes itself");
    assert!(error.contains("included models are nested more than 8 deep; help: flatten them"), "{error}");
}

#[test]
fn a_model_in_the_folder_of_the_world_may_include_another_one_there() {
    let include = |name: &str| format!("<include><uri>model://{name}</uri></include>");
    let set =
        format!("<sdf version='1.6'><model name='set'><static>1</static>{}</model></sdf>", include("table"));
    let table = format!("<sdf version='1.6'>{}</sdf>", model("table", "<pose>1 2 0 0 0 0</pose>", BOX));
    let files = [
        ("w.world", world(&include("set"))),
        ("models/set/model.sdf", set),
        ("models/table/model.sdf", table),
    ];
    let folder = Folder::new(&files.each_ref().map(|(name, text)| (*name, text.as_bytes())));
    let imported = folder.import("w.world").expect("a world");
    assert!((distance(&imported, 1.0, 2.0) + 0.25).abs() < 1e-3);
    folder.write("models/set/model.sdf", b"<sdf version='1.6'><light name='lamp'/></sdf>");
    let error = folder.import("w.world").expect_err("nothing is left");
    assert!(error.contains("included files without a model are left out: model://set"), "{error}");
}

#[test]
fn the_saved_state_of_a_world_places_included_models_too() {
    let include =
        |name: &str| format!("<include><uri>model://guest</uri>{name}<pose>9 9 0 0 0 0</pose></include>");
    let state = "<state><model name='guest'><pose>1 2 0 0 0 0</pose></model>\
                 <model name='second'><pose>-3 2 0 0 0 0</pose></model></state>";
    let text = world(&[include(""), include("<name>second</name>"), state.into()].concat());
    let guest = format!("<sdf version='1.6'>{}</sdf>", model("guest", "", BOX));
    let folder = Folder::new(&[("w.world", text.as_bytes()), ("models/guest/model.sdf", guest.as_bytes())]);
    let imported = folder.import("w.world").expect("a world");
    for (x, y) in [(1.0, 2.0), (-3.0, 2.0)] {
        assert!((distance(&imported, x, y) + 0.25).abs() < 1e-3, "({x}, {y})");
    }
}

#[test]
fn models_that_are_too_large_together_are_refused_at_the_include() {
    let include = "<include><uri>model://table</uri></include>";
    let spaces = " ".repeat(17 << 20);
    let table = format!("<sdf version='1.6'>{}</sdf>{spaces}", model("table", "", BOX));
    let twice = world(&format!("{include}\n{include}"));
    let folder = Folder::new(&[("w.world", twice.as_bytes()), ("models/table/model.sdf", table.as_bytes())]);
    let error = folder.import("w.world").expect_err("34 MiB");
    assert_eq!(error, "w.world:4:1: the included models are larger than 32 MiB together; help: remove some");
}

/// An included model counts as one level, like a model in the same file.
#[test]
fn models_may_be_nested_8_deep_whether_or_not_they_are_included() {
    let folder = Folder::new(&[]);
    let options = ImportOptions { models: vec![folder.path("")], ..ImportOptions::default() };
    let is_imported = |innermost: &str| {
        folder.write("w.world", world(innermost).as_bytes());
        folder.import_with("w.world", &options).is_ok()
    };
    let within = |inner: &str| format!("<model name='m'><static>1</static>{inner}</model>");
    let mut inside = model("m0", "", BOX);
    let mut included = inside.clone();
    for depth in 0..=9 {
        let file = format!("<sdf version='1.6'>{included}</sdf>");
        folder.write(&format!("m{depth}/model.sdf"), file.as_bytes());
        let include = format!("<include><uri>model://m{depth}</uri></include>");
        assert_eq!((is_imported(&inside), is_imported(&include)), (depth <= 8, depth <= 8), "{depth} deep");
        (inside, included) = (within(&inside), within(&include));
    }
}

#[test]
fn parts_that_a_scenario_cannot_represent_are_listed() {
    let parts = [
        model("fine", "", BOX),
        model("statue", "", "<mesh><uri>a.dae</uri></mesh>"),
        model("leaning", "<pose>3 0 0 0.3 0 0</pose>", BOX),
        model("lamp", "<pose>0 3 3 0 0 0</pose>", BOX),
        model("step", "<pose>0 5 -0.9 0 0 0</pose>", BOX),
        model("crate", "<plugin filename='libpush.so' name='p'/>", BOX)
            .replace("<static>1</static>", "<pose>0 -3 0 0 0 0</pose>"),
        model("robot", "<joint name='j' type='revolute'/>", BOX),
        "<plugin filename='libworld.so' name='p'/><actor name='walker'/>".into(),
        model("relative", "<pose relative_to='fine'>0 0 0 0 0 0</pose>", BOX),
        model("saved", "<pose>0 6 0 0 0 0</pose>", BOX),
        "<state><model name='saved'><pose relative_to='fine'>0 0 0 0 0 0</pose></model></state>".into(),
        // The pose of a collision is relative to its link, unless it says otherwise.
        model("aside", "", BOX)
            .replace("<geometry>", "<pose relative_to='__model__'>0 0 0 0 0 0</pose><geometry>"),
        "<include><uri>model://guest</uri><pose relative_to='fine'>1 0 0 0 0 0</pose></include>".into(),
        model("ground", "<pose>0 0 -0.5 0 0 0</pose>", "<plane><normal>0 0 1</normal></plane>"),
        model("cellar", "<pose>0 0 -1 0 0 0</pose>", "<plane/>"),
        model("end", "", "<plane><normal>1 0 0</normal></plane>"),
        model("deck", "<pose>0 0 1 0 0 0</pose>", "<plane/>"),
    ];
    let guest = format!("<sdf version='1.6'>{}</sdf>", model("guest", "", BOX));
    let folder = Folder::new(&[
        ("w.world", world(&parts.concat()).as_bytes()),
        ("models/guest/model.sdf", guest.as_bytes()),
    ]);
    let imported = folder.import("w.world").expect("a world");
    assert_eq!(imported.scenario.obstacles.len(), 2, "fine and crate");
    let expected = [
        "plugins do not run: libworld.so, libpush.so",
        "actors are left out: walker",
        "poses relative to other frames are not understood, so these are left out: model://guest, relative, saved, aside/c",
        "meshes are left out: statue/c",
        "rolled or pitched shapes are left out: leaning/c",
        "shapes above the LIDAR, which is at a height of 0.18 m, are left out: lamp/c",
        "shapes below the LIDAR, which is at a height of 0.18 m, are left out: step/c",
        "models that could be pushed stand still: crate",
        "models with joints, such as robots, are left out: robot",
        "planes that are sloping, vertical or above the ground are left out: end/c, deck/c",
    ];
    assert_eq!(imported.findings, expected);
    assert!(imported.text().starts_with("// Not imported: plugins do not run: libworld.so, libpush.so.\n"));
}

#[test]
fn invalid_worlds_are_rejected_with_the_file_and_a_fix() {
    let deep = format!("{}{}", "<model name='m'>".repeat(12), "</model>".repeat(12));
    for (text, expected) in [
        (
            world(&model("m", "", "<box><size>1 nan 1</size></box>")),
            "w.world:3:111: <size> is `1 nan 1`; help: write 3 finite numbers",
        ),
        (
            world(&model("m", "", "<box><size>1 -1 1</size></box>")),
            "w.world:3:111: <size> of the box is `1 -1 1`; help: write sizes from 0.001 to 1000 m",
        ),
        (
            world(&model("m", "", "<cylinder><radius>1</radius></cylinder>")),
            "w.world:3:106: <cylinder> has no <length>; help: add it",
        ),
        (
            world(&model("m", "<pose>1 2 3</pose>", BOX)),
            "w.world:3:35: <pose> is `1 2 3`; help: write 6 finite numbers",
        ),
        (
            world(&model("m", "", "<mesh/>")),
            "w.world: nothing in it can be imported: meshes are left out: m/c; help: ",
        ),
        (world(""), "w.world: nothing in it can be imported: it has no collision shapes; help: "),
        (world(&deep), "w.world:3:"),
        ("<sdf>\n<world>".into(), "w.world:1:1: not readable XML: the root node was opened but never closed"),
        ("<html/>".into(), "w.world:1:1: not an SDF file"),
        (
            "<!DOCTYPE a [<!ENTITY b 'bb'>]><sdf>&b;</sdf>".into(),
            "w.world:1:1: not readable XML: XML with DTD detected",
        ),
        (
            world(&model("m", "", "<box><size>900 900 1</size></box>")),
            "w.world: the world is 902 m x 902 m, too large for a robot that keeps 0.130 m from walls",
        ),
    ] {
        let folder = Folder::new(&[("w.world", text.as_bytes())]);
        let error = folder.import("w.world").expect_err("invalid");
        assert!(error.starts_with(expected) && error.contains("help: "), "{error}");
    }
}

#[test]
fn invalid_maps_are_rejected_with_the_file_and_the_problem() {
    let black = pgm(20, 20, |_, _| 0);
    let whole = hall();
    for (yaml, image, expected) in [
        (
            YAML.replace("map.pgm", "other.png"),
            &whole[..],
            "map.yaml:1:8: there is no image `other.png`; help: ",
        ),
        (YAML.replace("0.05", "0"), &whole, "map.yaml:2:13: `resolution` is 0"),
        (YAML.into(), &whole[..5000], "map.pgm: not a complete image: "),
        (
            YAML.into(),
            &black,
            "map.yaml: the robot fits nowhere on this map: it needs more than 0.143 m of free cells to each side; help: ",
        ),
        (String::new(), &whole, "map.yaml: `image` is missing; help: "),
    ] {
        let folder = Folder::new(&[("map.yaml", yaml.as_bytes()), ("map.pgm", image)]);
        let error = folder.import("map.yaml").expect_err("invalid");
        assert!(error.starts_with(expected), "{error}");
    }
    let folder = Folder::new(&[("a.txt", b"x")]);
    let error = folder.import("a.txt").expect_err("another kind");
    assert!(error.starts_with("a.txt: not a kind of file that can be imported; help: "), "{error}");
    assert!(folder.import("missing.yaml").is_err() && folder.import("missing.world").is_err());
}

const BARN: &str = r#"{"radius_m": 0.075, "start_m": [-2.25, 3.0], "heading_rad": 1.57, "goal_m": [-2.25, 13.0],
"goal_radius_m": 1.0, "time_limit_s": 100, "worlds": [
{"world": 3, "circles_m": [[-0.075, 5.0], [-4.425, 5.0]], "metric_path_length_m": 10.5},
{"world": 7, "circles_m": [[-2.25, 8.0]]}]}"#;

#[test]
fn barn_worlds_have_their_start_goal_and_path_length() {
    let folder = Folder::new(&[("barn.json", BARN.as_bytes())]);
    let error = folder.import("barn.json").expect_err("many worlds");
    assert_eq!(
        error,
        "barn.json: it holds many worlds; help: choose one with --world N, or name a folder with --out"
    );
    let one = |world| {
        folder.import_with("barn.json", &ImportOptions { world: Some(world), ..ImportOptions::default() })
    };
    let imported = one(3).expect("a world");
    assert_eq!(imported.path_length_m, Some(10.5));
    let scenario = &imported.scenario;
    assert_eq!((scenario.obstacles.len(), scenario.task.max_episode_steps), (2, 500));
    let route = scenario.benchmark_route.expect("a route");
    assert!((route.goal_m - route.start_m - vec2(0.0, 10.0)).length() < 1e-4);
    assert!((distance(&imported, -0.5, 5.0) - 0.35).abs() < 1e-3);
    assert!(
        one(4)
            .expect_err("no such world")
            .starts_with("barn.json: it has no world 4; help: --world takes a number from 3 to 7")
    );
    let all = import_worlds(&folder.path("barn.json"), &ImportOptions::default()).expect("all worlds");
    assert_eq!(all.iter().map(|(name, _)| &**name).collect::<Vec<_>>(), ["barn-003", "barn-007"]);
    folder.write("barn.json", BARN.replace("[[-2.25, 8.0]]", "[[-2.25]]").as_bytes());
    let error = one(7).expect_err("invalid");
    assert!(error.starts_with("barn.json:4:") && error.contains("not a file of BARN worlds: "), "{error}");
    folder.write("barn.json", b"{\"stages\": [}");
    let error = one(7).expect_err("not JSON");
    assert!(
        error.starts_with("barn.json:1:") && error.contains("not a file of BARN worlds or stages: "),
        "{error}"
    );
    folder.write("barn.json", "{\"stages\": \"\\u12é\"}".as_bytes());
    let error = one(7).expect_err("an invalid escape, found in the middle of a character");
    assert!(error.starts_with("barn.json:1:17: "), "{error}");
}

/// A room of 4 m x 3 m with a pillar and two discs that move.
const STAGES: &str = r#"{"about": "by hand", "stages": {
"2": {"static": [{"box": [0, 1.55, 4.2, 0.1, 0]}, {"box": [0, -1.55, 4.2, 0.1, 3.14159]}, {"note": "a lamp"},
                 {"box": [2.05, 0, 3, 0.1, 1.5708]}, {"box": [-2.05, 0, 3, 0.1, -1.5708]}, {"circle": [1, 0.5, 0.15]}],
      "moving": [{"radius_m": 0.16, "period_s": 40, "keys": [[0, -1, -1], [20, 1, -1], [40, -1, -1]]},
                 {"radius_m": 0.1, "keys": [[0, -1, 1], [10, -1, 0], [15, -1, 0]]}]},
"5": {"static": [{"box": [0, 1, 3, 0.1, 0]}, {"box": [0, -1, 3, 0.1, 0]}]}}}"#;

#[test]
fn moving_discs_of_a_stage_get_key_frames() {
    let folder = Folder::new(&[("stages.json", STAGES.as_bytes())]);
    let one = |world| {
        folder.import_with("stages.json", &ImportOptions { world: Some(world), ..ImportOptions::default() })
    };
    let imported = one(2).expect("a stage");
    assert_eq!(imported.findings, ["notes are not read: a lamp"]);
    let Scenario { name, obstacles, robot, task, lidar, .. } = &imported.scenario;
    assert_eq!(name, "stages.json stage 2");
    assert_eq!((robot.motions.len(), lidar.beams), (15, 40));
    assert_eq!((task.collision_range_m, task.goal_radius_m, task.max_episode_steps), (0.13, 0.2, 250));
    assert_eq!(obstacles.len(), 7);
    let frame = |time_s, x, y| KeyFrame { time_s, position_m: vec2(x, y) };
    let moving = |end, frames: &[KeyFrame]| ObstacleMotion::KeyFrames { frames: frames.to_vec(), end };
    assert_eq!(obstacles[5].position_m, vec2(-1.0, -1.0));
    assert_eq!(obstacles[5].motion, moving(KeyFrameEnd::Loop { period_s: 40.0 }, &[frame(20.0, 1.0, -1.0)]));
    let there = [frame(10.0, -1.0, 0.0), frame(15.0, -1.0, 0.0)];
    assert_eq!(obstacles[6].motion, moving(KeyFrameEnd::Stop, &there));
    let (x, y, _) = pose_at(&obstacles[5], 50, 0.2);
    assert!(x.abs() < 1e-6 && y == -1.0, "half-way after 10 s, not at ({x}, {y})");
    let names = import_worlds(&folder.path("stages.json"), &ImportOptions::default()).expect("all");
    assert_eq!(names.iter().map(|(name, _)| &**name).collect::<Vec<_>>(), ["stage-2", "stage-5"]);
    let start_m = imported.scenario.benchmark_route.expect("a route").start_m;
    let there = format!("[[0, {}, {}], [10, -1, 0]]", start_m.x, start_m.y);
    folder.write("stages.json", STAGES.replace("[[0, -1, 1], [10, -1, 0], [15, -1, 0]]", &there).as_bytes());
    assert_eq!(one(2).expect("valid").scenario.benchmark_route, None, "something stands at its start");
    folder.write("stages.json", STAGES.as_bytes());
    assert!(
        one(3)
            .expect_err("no such stage")
            .contains("it has no world 3; help: --world takes a number from 2 to 5")
    );
    for (from, to, expected) in [
        ("\"circle\"", "\"cone\"", "stages.json:3:"),
        ("0.15]", "0]", "stages.json: stage 2: a size is not above 0; help: "),
        ("0.15]", "2e6]", "stages.json: stage 2: it has the number 2000000, beyond a million; help: "),
        (
            "[[0, -1, 1], [10, -1, 0], [15, -1, 0]]",
            "[]",
            "stages.json: stage 2: something moves, but has no `keys`; ",
        ),
        (
            "[20, 1, -1]",
            "[50, 1, -1]",
            "stages.json: stage 2: the scenario would be invalid: `obstacles[5].motion.",
        ),
        (
            "[20, 1, -1]",
            "[0.1, 1, -1]",
            "stages.json: stage 2: the scenario would be invalid: `obstacles[5].motion.",
        ),
        ("\"period_s\"", "\"periods\"", "stages.json:4:"),
    ] {
        folder.write("stages.json", STAGES.replacen(from, to, 1).as_bytes());
        let error = one(2).expect_err(to);
        assert!(error.starts_with(expected), "{error}");
    }
}

#[test]
fn a_barn_world_with_its_path_file_has_barns_task() {
    let cylinder = "<cylinder><radius>0.075</radius><length>1</length></cylinder>";
    let text = world(&model("unit_cylinder_0", "<pose>-0.075 5.0 0 0 0 0</pose>", cylinder));
    let header = "{'descr': '<i8', 'fortran_order': False, 'shape': (2, 2), }\n";
    let mut path =
        [&b"\x93NUMPY\x01\0"[..], &(header.len() as u16).to_le_bytes(), header.as_bytes()].concat();
    path.extend([15_i64, 0, 15, 20].iter().flat_map(|value| value.to_le_bytes()));
    let folder = Folder::new(&[("world_7.world", text.as_bytes()), ("path_files/path_7.npy", &path)]);
    let imported = folder.import("world_7.world").expect("a world");
    // The cells are (-2.325, 5.075) and (-2.325, 8.075).
    let length_m = 0.075_f64.hypot(2.075) + 3.0 + 0.075_f64.hypot(4.925);
    assert!((imported.path_length_m.expect("a length") - length_m).abs() < 1e-9);
    assert_eq!(imported.scenario.robot.radius_m, 0.3, "the Jackal");
    let scenario_1 = ImportOptions { robot_from: Some(Scenario::default()), ..ImportOptions::default() };
    assert_eq!(
        folder.import_with("world_7.world", &scenario_1).expect("a world").scenario.robot.radius_m,
        0.1
    );
    folder.write("path_files/path_7.npy", b"PK\x03\x04");
    let error = folder.import("world_7.world").expect_err("invalid");
    assert_eq!(error, "path_files/path_7.npy: not a .npy file; help: fetch the file again");
}

#[test]
fn shapes_are_cut_at_the_height_of_the_lidar() {
    let ball = model("ball", "<pose>0 0 0 0 0 0</pose>", "<sphere><radius>0.5</radius></sphere>");
    let folder = Folder::new(&[("w.world", world(&ball).as_bytes())]);
    let radius = |height_m: f64| {
        let options = ImportOptions { lidar_height_m: height_m, ..ImportOptions::default() };
        match folder.import_with("w.world", &options).map(|found| found.scenario.obstacles[0].shape.clone()) {
            Ok(Shape::Circle { radius_m }) => Some(radius_m),
            _ => None,
        }
    };
    // Its centre is 0.5 m above the ground.
    assert_eq!((radius(0.5), radius(0.1), radius(1.1)), (Some(0.5), Some(0.3), None));
}

#[test]
fn an_enclosed_court_that_the_robot_cannot_enter_is_filled() {
    let mut walls = String::new();
    for (k, (x, y, width, height)) in
        [(0.0, 1.0, 2.2, 0.2), (0.0, -1.0, 2.2, 0.2), (1.0, 0.0, 0.2, 2.2), (-1.0, 0.0, 0.2, 2.2)]
            .iter()
            .enumerate()
    {
        let geometry = format!("<box><size>{width} {height} 1</size></box>");
        walls += &model(&format!("wall{k}"), &format!("<pose>{x} {y} 0 0 0 0</pose>"), &geometry);
    }
    let outside = model("far", "<pose>4 4 0 0 0 0</pose>", BOX);
    let folder = Folder::new(&[("w.world", world(&(walls + &outside)).as_bytes())]);
    let imported = folder.import("w.world").expect("a world");
    let free: Vec<Vec2> = (-9..=9)
        .flat_map(|x| (-9..=9).map(move |y| vec2(x as f32 * 0.1, y as f32 * 0.1)))
        .filter(|at| distance(&imported, f64::from(at.x), f64::from(at.y)) >= 0.35)
        .collect();
    assert_eq!(free, [], "no start or goal can be placed in the court");
}

#[test]
fn a_device_or_a_folder_is_not_read_as_an_image() {
    let folder = Folder::new(&[("map.yaml", YAML.as_bytes()), ("map.pgm/x", b"")]);
    let error = folder.import("map.yaml").expect_err("a folder");
    assert!(error.starts_with("map.yaml:1:8: there is no image `map.pgm`"), "{error}");
    if Path::new("/dev/zero").exists() {
        folder.write("map.yaml", YAML.replace("map.pgm", "/dev/zero").as_bytes());
        let error = folder.import("map.yaml").expect_err("a device");
        assert!(error.starts_with("/dev/zero: it is a device or a pipe; help: "), "{error}");
    }
}
