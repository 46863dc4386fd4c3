//! Why the studio does not start, or why its window was lost.

opruga::math::messages! {
    /// Why the studio does not start, or why its window was lost.
    #[derive(Clone, Debug, PartialEq)]
    pub enum StartError {
        /// An argument is not text.
        "studio.call" #[error("`{argument}` is not UTF-8 text")]
        NotUtf8 { argument: String },
        /// An unknown option.
        "studio.call" #[error("there is no option `{option}`")]
        NoOption { option: String },
        /// Several scenes.
        "studio.call" #[error("{count} scenes are named")] #[allowed("at most one")]
        SeveralScenes { count: usize },
        /// There is no screen, or the program cannot draw on it.
        "studio.no_window" #[error("no window can be opened: {reason}")]
        #[hint("`opruga run {scene}` runs without a window and writes pictures")]
        NoWindow { reason: String, scene: String },
        /// The process of the window does not start.
        "studio.no_window" #[error("the window cannot be started: {reason}")]
        NotStarted { reason: String },
        /// The window has ended by itself with an error.
        "studio.lost" #[error("the window was lost (exit code {code})")]
        ExitCode { code: i32 },
        /// A signal has ended the window.
        "studio.lost" #[error("the window was lost (signal {number})")]
        Signal { number: i32 },
    }
}
