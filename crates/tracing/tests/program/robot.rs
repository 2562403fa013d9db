//! A robot program as well-kept Rust programs are: instrumented, and without a word about monitors.

pub mod kicker {
    use tracing::{Instrument, instrument};

    #[instrument(ret)]
    pub fn ready(is_ready: bool) -> bool {
        is_ready
    }

    #[instrument]
    pub fn play() {
        tracing::debug!("playing");
    }

    #[instrument(skip_all)]
    pub fn ball_in_front(look: impl FnOnce()) {
        look();
    }

    /// Ends early by `?` where there is no ball.
    #[instrument(ret, err)]
    pub fn find_ball(bearing: Option<f64>) -> Result<f64, &'static str> {
        let bearing = bearing.ok_or("no ball")?;
        Ok(bearing + 0.5)
    }

    /// Panics where there is no ball.
    #[instrument(ret)]
    pub fn grab(bearing: Option<f64>) -> f64 {
        bearing.expect("a ball")
    }

    /// The same in async code, without its result: whoever polls it keeps the span.
    pub fn try_to_grab(bearing: Option<f64>) -> impl Future<Output = f64> {
        async move { bearing.expect("a ball") }.instrument(tracing::info_span!("try_to_grab"))
    }

    /// Waits for a ball that may never come.
    #[instrument(ret)]
    pub async fn await_ball(bearing: Option<f64>) -> f64 {
        match bearing {
            Some(bearing) => bearing,
            None => std::future::pending().await,
        }
    }

    #[instrument(skip_all)]
    pub fn play_then(go_on: impl FnOnce()) {
        go_on();
    }

    #[instrument(fields(robot = robot))]
    pub fn kick(robot: &str, power: f64) {
        tracing::debug!(power, "kicked");
    }

    #[instrument(skip_all)]
    pub async fn dribble<F: Future<Output = ()>>(steps: u32, step: impl Fn(u32) -> F) -> u32 {
        for n in 0..steps {
            step(n).await;
        }
        steps
    }
}

pub mod sensor_controller {
    use tracing::instrument;

    pub fn set_sonar(sonar: f64) {
        tracing::trace!(sonar);
    }

    /// Its span has the value once that is known.
    #[instrument(skip_all, fields(range))]
    pub fn measure(range: f64) {
        tracing::Span::current().record("range", range);
    }

    #[instrument(skip_all, fields(robot = robot, ball_dir))]
    pub fn read_ir(robot: &str, direction: Option<f32>) {
        if let Some(direction) = direction {
            tracing::Span::current().record("ball_dir", tracing::field::debug(direction));
        }
    }
}

/// Another robot's kicker, with a function of the same name.
pub mod rival {
    pub mod kicker {
        #[tracing::instrument]
        pub fn play() {}
    }
}
