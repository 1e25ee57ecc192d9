//! Walls of cells: their text, their geometry, their checks and their place in a file.

use proptest::prelude::*;
use wayfield_scenario::{
    Enclosure, IndexedScenario, Obstacle, ObstacleMotion, Scenario, Shape, Solid, SpatialIndex, Vec2, Wall,
    WallCells, clearance, diagnostics, nearest, notes, to_text, vec2,
};

/// A grid of 4 x 3 cells of 0.5 m around (0.5, 0): from (-0.5, -0.75) to (1.5, 0.75).
const TEXT: &str = "(
    name: \"Cells\",
    walls: [
        (cells: (
            rows: [
                \"##..\",
                \"#...\", // the door
                \"# .#\",
            ],
            cell_m: 0.5,
            centre_m: (0.5, 0.0),
        )),
    ],
)
";

fn wall(rows: &[&str], cell_m: f32, centre_m: Vec2) -> Wall {
    let rows = rows.iter().map(ToString::to_string).collect();
    Wall { cells: Some(WallCells::new(rows, cell_m, centre_m)), ..Wall::default() }
}

fn with_walls(walls: Vec<Wall>) -> Scenario {
    Scenario { walls, ..Scenario::default() }
}

fn problems(text: &str) -> String {
    Scenario::parse(text, "map.ron").expect_err("it is invalid").to_string()
}

#[test]
fn the_upper_row_of_the_text_is_the_upper_row_of_the_plane() {
    let scenario = Scenario::parse(TEXT, "map.ron").expect("valid");
    assert_eq!(scenario.walls, [wall(&["##..", "#...", "# .#"], 0.5, vec2(0.5, 0.0))]);
    let rectangles: Vec<_> = scenario.walls[0].pieces().map(|at| (at.shape, at.position_m)).collect();
    let rectangle = |width_m, height_m| Shape::Rectangle { width_m, height_m };
    let expected = [
        (rectangle(0.5, 1.5), vec2(-0.25, 0.0)),
        (rectangle(0.5, 0.5), vec2(1.25, -0.5)),
        (rectangle(0.5, 0.5), vec2(0.25, 0.5)),
    ];
    assert_eq!(rectangles, expected, "from the lower left, as wide, then as high as possible");
    for (point, distance_m) in [
        (vec2(0.5, 0.0), 0.25),
        (vec2(0.25, 0.6), -0.15),
        (vec2(1.25, 0.25), 0.5),
        (vec2(-0.5, 1.0), 0.25),
        // The lower right cell has a corner at (1.0, -0.25): a 3-4-5 triangle.
        (vec2(0.85, -0.05), 0.25),
    ] {
        let (solid, found_m) = nearest(&scenario, point, 0);
        assert!(solid == Solid::Wall(0) && (found_m - distance_m).abs() < 1e-6, "{point}: {found_m}");
    }
}

#[test]
fn cells_keep_the_text_of_their_file() {
    let scenario = Scenario::parse(TEXT, "map.ron").expect("valid");
    assert_eq!(to_text(&scenario, Some(TEXT)), TEXT);
    let mut moved = scenario.clone();
    let cells = moved.walls[0].cells.take().expect("cells");
    moved.walls[0].cells = Some(cells.with_centre(vec2(0.25, 0.0)));
    assert_eq!(to_text(&moved, Some(TEXT)), TEXT.replace("(0.5, 0.0)", "(0.25, 0.0)"));
    let short = to_text(&scenario, None);
    assert!(!short.contains("corners_m") && !short.contains("thickness_m"), "{short}");
    assert_eq!(Scenario::parse(&short, "short.ron").expect("valid"), scenario);
}

#[test]
fn cells_that_are_wrong_are_named_with_their_line_and_a_fix() {
    for (right, wrong, expected) in [
        (
            "\"#...\"",
            "\"#..\"",
            "7:17: `walls[0].cells.rows[1]` has 3 cells, but the first row has 4: write rows of the same length",
        ),
        (
            "\"##..\"",
            "\"#x..\"",
            "6:17: `walls[0].cells.rows[0]` has `x` in column 2: write # for a solid cell, or . for a free one",
        ),
        (
            "cell_m: 0.5",
            "cell_m: 0.0",
            "10:21: `walls[0].cells.cell_m` is 0: write a number from 0.01 to 100 (metres)",
        ),
        ("cell_m: 0.5,", "", "4:17: `walls[0].cells` lacks the field `cell_m`: add `cell_m: ...`"),
        (
            "(0.5, 0.0)",
            "(1.5, 0.0)",
            "4:17: `walls[0].cells` extend 0.500 m outside the enclosure: move `centre_m`, write a smaller",
        ),
        (
            "(cells:",
            "(corners_m: [(0, 0), (1, 0)], cells:",
            "4:9: `walls[0]` has corners and cells: write only one of them, or two walls",
        ),
    ] {
        let found = problems(&TEXT.replace(right, wrong));
        assert!(found.contains(&format!("map.ron:{expected}")), "{found}\nis not\n{expected}");
    }
    let found = problems("(name: \"a\", walls: [(thickness_m: 0.2)])");
    assert!(
        found
            .contains("map.ron:1:21: `walls[0]` has neither corners nor cells: write `corners_m` or `cells`"),
        "{found}"
    );
    let of_rows =
        |rows: &str| problems(&format!("(name: \"a\", walls: [(cells: (rows: [{rows}], cell_m: 0.1))])"));
    let found = of_rows("\"...\", \"...\"");
    assert!(found.contains("`walls[0].cells.rows` has no solid cell: write # for at least one"), "{found}");
    assert!(of_rows("").contains("`walls[0].cells.rows` has 0 cells: write 1 to 250000"));
    // A first row and a number of rows that would make 3.6e9 cells.
    let found = of_rows(&format!("\"{}\",{}", "#".repeat(60_000), "\"#\",".repeat(60_000)));
    assert!(found.contains("has 3600060000 cells: write 1 to 250000"), "{found}");
}

#[test]
fn cells_that_form_too_many_rectangles_are_refused() {
    // A chessboard of 150 x 150 cells has 11,250 solid ones.
    let row = |odd: bool| (0..150).map(|k| if (k % 2 == 1) == odd { '#' } else { '.' }).collect::<String>();
    let rows: Vec<String> = (0..150).map(|k| row(k % 2 == 1)).collect();
    let cells = WallCells::new(rows, 0.02, Vec2::ZERO);
    let found = diagnostics(&with_walls(vec![Wall { cells: Some(cells), ..Wall::default() }]));
    let message = "have 11250 segments and rectangles of cells in total: write at most 10000";
    assert!(found.len() == 1 && found[0].path == "walls" && found[0].message == message, "{found:?}");
}

#[test]
fn starts_in_cells_and_goals_behind_them_are_found() {
    let closed = with_walls(vec![wall(&["########"], 0.5, Vec2::ZERO)]);
    let found = diagnostics(&closed);
    assert!(found.iter().any(|found| found.message.contains("which the robot can't reach")), "{found:?}");
    let door = with_walls(vec![wall(&["###.####"], 0.5, Vec2::ZERO)]);
    assert_eq!(diagnostics(&door), []);
    let start =
        "(name: \"a\", walls: [(cells: (rows: [\"#\"], cell_m: 1.0))], starts: Fixed(position_m: (0, 0.1)))";
    assert!(
        problems(start).contains("`starts.position_m` is 0.400 m inside `walls[0]`: "),
        "{}",
        problems(start)
    );
    let circle = Obstacle {
        shape: Shape::Circle { radius_m: 0.1 },
        position_m: vec2(-1.0, 0.2),
        rotation_rad: 0.0,
        motion: ObstacleMotion::Static,
    };
    let found = notes(&Scenario { obstacles: vec![circle], ..door });
    let overlap = found.iter().filter(|note| note.diagnostic.message.contains("wall 1 (`walls[0]`)")).count();
    assert_eq!(overlap, 1, "{found:?}");
}

proptest! {
    #[test]
    fn cells_are_as_near_as_one_obstacle_per_cell(
        bits in prop::collection::vec(any::<bool>(), 15 * 12),
        points in prop::collection::vec((-4.0_f32..4.0, -4.0_f32..4.0), 30),
    ) {
        prop_assume!(bits.contains(&true));
        let row = |bits: &[bool]| bits.iter().map(|&bit| if bit { '#' } else { '.' }).collect::<String>();
        let rows: Vec<String> = bits.chunks(15).map(row).collect();
        let cells = WallCells::new(rows, 0.25, vec2(0.5, -0.25));
        let enclosure = Enclosure::Rectangle { width_m: 9.0, height_m: 9.0 };
        let wall = Wall { cells: Some(cells), ..Wall::default() };
        let walled = Scenario { enclosure: enclosure.clone(), walls: vec![wall], ..Scenario::default() };
        let (low, high) = (vec2(0.5, -0.25) - vec2(15.0, 12.0) * 0.125, vec2(0.5, -0.25) + vec2(15.0, 12.0) * 0.125);
        let one = |k: usize| Obstacle {
            shape: Shape::Rectangle { width_m: 0.25, height_m: 0.25 },
            position_m: vec2(low.x + 0.25 * ((k % 15) as f32 + 0.5), high.y - 0.25 * ((k / 15) as f32 + 0.5)),
            rotation_rad: 0.0,
            motion: ObstacleMotion::Static,
        };
        let obstacles = (0..bits.len()).filter(|&k| bits[k]).map(one).collect();
        let separate = Scenario { enclosure, obstacles, ..Scenario::default() };
        let index = SpatialIndex::new(&walled);
        let indexed = IndexedScenario { index: index.as_ref(), ..(&walled).into() };
        for (x, y) in points {
            let (by_cells, by_obstacles) = (clearance(&walled, vec2(x, y), 0), clearance(&separate, vec2(x, y), 0));
            // Inside, a rectangle of several cells is deeper than one cell.
            prop_assert!((by_cells - by_obstacles).abs() < 1e-5 || by_cells.max(by_obstacles) <= 1e-5);
            prop_assert_eq!(indexed.nearest(vec2(x, y), 0).1.to_bits(), by_cells.to_bits());
        }
    }
}
