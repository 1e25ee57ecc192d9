//! The options of `--reproduce`.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::seeds::Seeds;
use super::shard::Shard;
use crate::run::settings::Settings;
use crate::scenario::quoted;

/// The options of a reproduction.
#[derive(Clone, Debug, Default)]
pub struct ReproduceOptions {
    /// Experiment files of the user; if there are none, all shipped experiments.
    pub experiments: Vec<PathBuf>,
    /// Names of figures, tables or experiments; if there are none, all of them.
    pub only: Vec<String>,
    /// The seeds, instead of the experiments' own.
    pub seeds: Option<Seeds>,
    /// Settings of all stages, after the experiments' own.
    pub settings: Settings,
    /// Whether to run a short version with a tenth of the training.
    pub quick: bool,
    /// The report's folder, instead of the default one.
    pub out: Option<PathBuf>,
    /// The part of the training runs to do, without a report; `None` for all of them and the report.
    pub shard: Option<Shard>,
    /// The number of runs in parallel, instead of one per core.
    pub jobs: Option<usize>,
}

impl ReproduceOptions {
    /// The report's folder if `out` names none: `runs/reproduce`, followed by the names of the user's experiments and
    /// by `quick` if that applies.
    #[must_use]
    pub fn default_folder(&self) -> PathBuf {
        let mut name = "reproduce".to_owned();
        for experiment in &self.experiments {
            name += &format!("-{}", experiment.file_stem().unwrap_or_default().to_string_lossy());
        }
        Path::new("runs").join(name + if self.quick { "-quick" } else { "" })
    }

    /// The command that makes this report, for a shell.
    #[must_use]
    pub fn command(&self) -> String {
        let mut words: Vec<OsString> = vec!["wayfield".into(), "--reproduce".into()];
        let mut flag = |name: &str, value: OsString| words.extend([name.into(), value]);
        for experiment in &self.experiments {
            flag("--experiment", experiment.into());
        }
        if !self.only.is_empty() {
            flag("--only", self.only.join(",").into());
        }
        if let Some(seeds) = &self.seeds {
            flag("--seeds", seeds.flag_value().into());
        }
        for setting in &self.settings.0 {
            flag("--set", setting.to_string().into());
        }
        if let Some(out) = &self.out {
            flag("--out", out.into());
        }
        if let Some(jobs) = self.jobs {
            flag("--jobs", jobs.to_string().into());
        }
        if self.quick {
            words.push("--quick".into());
        }
        words.iter().map(quoted).collect::<Vec<_>>().join(" ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::settings::Setting;

    #[test]
    fn the_command_of_a_report_has_every_option() {
        let setting = Setting { path: "learning.gamma".into(), value: "0.9".into() };
        let options = ReproduceOptions {
            experiments: vec!["a b.ron".into(), "c.ron".into()],
            only: vec!["fig9".into(), "table2".into()],
            seeds: Some(Seeds::List(vec![17])),
            settings: Settings(vec![setting]),
            quick: true,
            out: Some("here".into()),
            shard: None,
            jobs: Some(3),
        };
        assert_eq!(
            options.command(),
            "wayfield --reproduce --experiment 'a b.ron' --experiment c.ron --only fig9,table2 --seeds 17, \
             --set 'learning.gamma=0.9' --out here --jobs 3 --quick"
        );
        assert_eq!(ReproduceOptions::default().command(), "wayfield --reproduce");
        let five = ReproduceOptions { seeds: Some(Seeds::First(5)), ..ReproduceOptions::default() };
        assert_eq!(five.command(), "wayfield --reproduce --seeds 5");
    }
}
