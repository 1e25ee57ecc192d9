//! The mode `--export`: writes a policy for other programs.

use std::path::{Path, PathBuf};

use clap::Args;

use super::output::print_stdout;
use crate::run::RunError;
use crate::run::export::{ModelCardFile, export_onnx};
use crate::run::output_file::is_stream;
use crate::run::progress::print_stderr;

/// The options of `--export`.
#[derive(Args, Debug)]
#[command(next_help_heading = "Options of --export")]
pub struct ExportArgs {
    /// The ONNX file to write. A model card for Hugging Face, README.md, is written into the same folder
    #[arg(long, value_name = "FILE")]
    onnx: Option<PathBuf>,

    /// Test results for the model card: files with the output of --eval --json, one per scenario
    #[arg(long, value_name = "FILE", num_args = 1..)]
    eval_results: Vec<PathBuf>,
}

/// Exports the policy in the file at `path`, and prints the paths of the written files, unless the ONNX file itself goes to a
/// device or a pipe.
///
/// # Errors
/// No output file is given, the policy or a file of results is invalid, or a file cannot be written.
pub fn run(path: &Path, args: &ExportArgs) -> Result<(), RunError> {
    let Some(onnx) = &args.onnx else {
        return Err(RunError::InvalidInput("--export needs an output file; help: add --onnx FILE".into()));
    };
    let model_card = export_onnx(path, onnx, &args.eval_results)?;
    if is_stream(onnx) {
        return Ok(());
    }
    let mut text = format!("{}\n", onnx.display());
    match model_card {
        ModelCardFile::Written(page) => text += &format!("{}\n", page.display()),
        ModelCardFile::Kept(page) => print_stderr(&format!(
            "note: {}: not overwritten, because wayfield did not write it; help: for a model card, export into another folder",
            page.display()
        )),
        ModelCardFile::None => {}
    }
    print_stdout(&text)
}
