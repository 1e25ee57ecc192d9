//! The export of a policy for other programs: an ONNX file, and a model card in the same folder.

use std::fs::{self, File};
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};

use crate::export::{EvalResults, MODEL_CARD_MARK, model_card, to_onnx};
use crate::limits::MAX_EVAL_RESULTS_BYTES;
use crate::policy::Policy;
use crate::scenario::read_bytes;

use super::output_file::{check_writable, is_stream, write_atomic};
use super::{RunError, policy_card};

/// The file name of a model card on Hugging Face.
const MODEL_CARD: &str = "README.md";
/// The length of the part of an existing `README.md` that is searched for [`MODEL_CARD_MARK`], in bytes.
const MAX_SEARCHED_BYTES: u64 = 1 << 16;

/// The outcome for the model card.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ModelCardFile {
    /// It was written.
    Written(PathBuf),
    /// The folder has a file of this name that wayfield did not write; it was not changed.
    Kept(PathBuf),
    /// The ONNX file went to a device or a pipe, which has no folder of its own.
    None,
}

/// Writes the policy in the file `policy` into the ONNX file `onnx`, and its model card into the file `README.md` in the same
/// folder. The model card lists the results of tests in the files `eval_results`, which `--eval --json` has printed.
///
/// # Errors
/// `policy` is not a policy or has no policy card, a file of results is invalid or about another policy, `onnx` does not end in
/// `.onnx`, or a file cannot be written.
pub fn export_onnx(policy: &Path, onnx: &Path, eval_results: &[PathBuf]) -> Result<ModelCardFile, RunError> {
    check_extension(onnx)?;
    let from = policy;
    let policy = policy_card::read(from)?;
    let results = eval_results.iter().map(|path| read_results(path, &policy));
    let results = results.collect::<Result<Vec<_>, RunError>>()?;
    export_policy(&policy, from, onnx, &results)
}

/// Like [`export_onnx`], with a policy in memory, which error messages call `from`.
///
/// # Errors
/// As for [`export_onnx`].
pub fn export_policy(
    policy: &Policy,
    from: &Path,
    onnx: &Path,
    results: &[EvalResults],
) -> Result<ModelCardFile, RunError> {
    check_extension(onnx)?;
    check_writable(onnx)?;
    let bytes = to_onnx(policy).map_err(|error| RunError::invalid_input(from, error))?;
    write(onnx, &bytes)?;
    let Some(name) = onnx.file_name().filter(|_| !is_stream(onnx)) else { return Ok(ModelCardFile::None) };
    let card = model_card(policy, &name.to_string_lossy(), results)
        .map_err(|error| RunError::failed(from, error))?;
    let path = onnx.with_file_name(MODEL_CARD);
    if is_foreign(&path) {
        return Ok(ModelCardFile::Kept(path));
    }
    write(&path, card.as_bytes())?;
    Ok(ModelCardFile::Written(path))
}

fn read_results(path: &Path, policy: &Policy) -> Result<EvalResults, RunError> {
    let refuse = |why: String| {
        RunError::invalid_input(
            path,
            format!("{why}; help: give a file with the output of --eval with --json"),
        )
    };
    let bytes = read_bytes(path, MAX_EVAL_RESULTS_BYTES + 1)
        .map_err(|error| refuse(format!("can't be read ({error})")))?;
    if bytes.len() as u64 > MAX_EVAL_RESULTS_BYTES {
        return Err(refuse(format!("is larger than {MAX_EVAL_RESULTS_BYTES} bytes")));
    }
    EvalResults::parse(&bytes, policy).map_err(|error| RunError::invalid_input(path, error))
}

fn check_extension(onnx: &Path) -> Result<(), RunError> {
    if is_stream(onnx) || onnx.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("onnx")) {
        return Ok(());
    }
    Err(RunError::invalid_input(onnx, "not an ONNX file; help: give a file name that ends in .onnx"))
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    write_atomic(path, |file| file.write_all(bytes)).map_err(|error| RunError::not_written(path, error))
}

/// Whether there is something at `path` that this program did not write.
fn is_foreign(path: &Path) -> bool {
    let Ok(found) = fs::symlink_metadata(path) else { return false };
    if !found.is_file() {
        return true;
    }
    let mut text = Vec::new();
    let read = File::open(path).and_then(|file| file.take(MAX_SEARCHED_BYTES).read_to_end(&mut text));
    read.is_err() || !String::from_utf8_lossy(&text).contains(MODEL_CARD_MARK)
}
