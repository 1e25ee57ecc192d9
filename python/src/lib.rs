//! The native module of the Python package `wayfield`: environments, training, evaluation and policies.
//!
//! In: numbers, text and numpy arrays from the Python layer (`python/wayfield/`), which documents them for users. Out:
//! results, as JSON or as new arrays, and Python exceptions with the command line's messages. Every long call releases the
//! GIL and checks for Ctrl-C. A panic becomes a `RuntimeError`.
//!
//! | file | purpose |
//! |---|---|
//! | `env.rs` | environments |
//! | `step_details.rs` | the contents of a step's `info` |
//! | `env_options.rs` | the options of an environment |
//! | `observation_bounds.rs` | the bounds of an environment's observations |
//! | `arrays.rs` | new numpy arrays |
//! | `commands.rs` | actions and motions from arrays |
//! | `cluster.rs` | training runs as tasks for other machines |
//! | `benchmark.rs` | steps without Python, for comparison |
//! | `policy.rs` | policies |
//! | `driver.rs` | policies that drive robots outside wayfield |
//! | `train.rs` | training runs |
//! | `evaluate.rs` | evaluations |
//! | `suite.rs` | evaluations in suites |
//! | `tested.rs` | what is evaluated: policies and classical drivers |
//! | `act_function.rs` | Python functions that are evaluated |
//! | `files.rs` | shipped files, checks, drawings, the command line |
//! | `import.rs` | imports of maps and worlds |
//! | `errors.rs` | exceptions |

mod act_function;
mod arrays;
mod benchmark;
mod cluster;
mod commands;
mod driver;
mod env;
mod env_options;
mod errors;
mod evaluate;
mod files;
mod import;
mod observation_bounds;
mod policy;
mod step_details;
mod suite;
mod tested;
mod train;

use pyo3::prelude::*;

// The same allocator as in the program: rapier and dfdx allocate memory in every step.
#[global_allocator]
static GLOBAL: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Environments, training, evaluation and policies of wayfield. Use the package `wayfield`, which documents them.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::benchmark::benchmark;
    #[pymodule_export]
    use super::cluster::{NativeReport, build, is_task_done, run_task};
    #[pymodule_export]
    use super::driver::NativeDriver;
    #[pymodule_export]
    use super::env::NativeEnv;
    #[pymodule_export]
    use super::evaluate::{evaluate, evaluate_function, evaluation_scenario};
    #[pymodule_export]
    use super::files::{check, draw, draw_run, main, presets, scenario_text, scenarios, version};
    #[pymodule_export]
    use super::import::import_scenario;
    #[pymodule_export]
    use super::policy::NativePolicy;
    #[pymodule_export]
    use super::step_details::StepDetails;
    #[pymodule_export]
    use super::suite::evaluate_suite;
    #[pymodule_export]
    use super::tested::load_tested;
    #[pymodule_export]
    use super::train::{resume, train, training_task};
}
