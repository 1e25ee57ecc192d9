//! Reproducibility on any number of threads: the learned weights are the same bit for bit.

use std::process::Command;

use wayfield_learning::{Experience, Learner, LearningConfig, NetworkConfig, ReplayConfig};
use wayfield_random::{normal, stream, uniform_index};

/// Trains a learner and prints a checksum of its checkpoint. The test below runs it in child processes, because the thread
/// pool is created once per process.
#[test]
#[ignore = "run by any_number_of_threads_gives_the_same_bits"]
fn print_checksum() {
    let config = LearningConfig {
        // Matrix products of this size use several threads.
        network: NetworkConfig { hidden: vec![256, 256], ..NetworkConfig::default() },
        batch_size: 512,
        replay: ReplayConfig { capacity: 1000, ..LearningConfig::default().replay },
        ..LearningConfig::default()
    };
    let mut learner = Learner::new(&config, 28, 5, 1, 1).expect("a valid config");
    let mut noise = stream(1, "test", 0);
    for step in 0..540 {
        let observation: Vec<f32> = (0..28).map(|_| normal(&mut noise)).collect();
        learner.store(&Experience {
            env_index: 0,
            observation: &observation,
            action: uniform_index(&mut noise, 5),
            reward: normal(&mut noise),
            next_observation: &observation,
            terminated: false,
            truncated: step % 10 == 0,
        });
        learner.train().expect("no divergence");
    }
    let mut bytes = Vec::new();
    learner.save(&mut bytes).expect("memory can be written");
    // Without the checksum at the end: the CRC of data followed by its CRC is a constant.
    let content = &bytes[..bytes.len() - 4];
    println!("checksum {:08x}, gradient steps {}", crc32c::crc32c(content), learner.gradient_steps());
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let run = |threads: &str| {
        let test = std::env::current_exe().expect("the path of the test program");
        let output = Command::new(test)
            .args(["--exact", "print_checksum", "--ignored", "--nocapture"])
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .expect("the test program starts");
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        text.lines().find_map(|line| line.split_once("checksum ")).expect(&text).1.to_string()
    };
    let one = run("1");
    assert!(!one.ends_with(" 0"), "the learner has taken gradient steps: {one}");
    for threads in ["2", "3", "8"] {
        assert_eq!(run(threads), one, "{threads} threads");
    }
}
