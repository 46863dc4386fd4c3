//! Errors in a sweep, its ranges, its metrics and its table.

use opruga_math::{messages, terms};

terms! {
    /// Errors in a range.
    pub enum RangeFault = "part.range_fault" {
        Ends = "the ends of the range are not numbers",
        TwoLogs = "the range has `log` twice",
        TwoWholes = "the range has `whole` twice",
        TwoCounts = "the range gives the number of values twice",
        Count = "the range has an invalid number of values; it needs at least 2",
        Word = "the range has an unknown part",
        Order = "the lower end is not below the upper end",
        Ratios = "a range of equal ratios must begin above 0",
    }
}

terms! {
    /// Errors in the table of a sweep or in a row of it.
    pub enum RowFault = "part.row_fault" {
        NoChecksums = "the rows have no checksums: an earlier version of the program wrote the table",
        Head = "the header of the table does not belong to this sweep",
        TwoRows = "the table has two rows for this point",
        Quote = "the row has an unclosed quote",
        Cells = "the number of cells in the row differs from that of the header",
        PointNumber = "invalid point number",
        NoPoint = "the sweep has no such point",
        Values = "the row has values of another point",
        Status = "the status is missing",
        Number = "the row has an invalid number",
    }
}

messages! {
    /// Why a sweep is refused.
    #[derive(Clone, Debug, PartialEq)]
    pub enum SweepError {
        "sweep.values" #[error("a value contains a control character")] #[value("{text}")] #[allowed("values on one line")]
        ControlCharacter { text: String },
        "sweep.values" #[error("a value is missing from the list")] #[value("{text}")] #[allowed("values with single commas between them")]
        NoValue { text: String },
        "sweep.range" #[error("{fault}")] #[value("{text}")]
        #[allowed("LOW..HIGH:COUNT, with :log for equal ratios and :whole for whole numbers")]
        #[hint("for example 10..1000:log:7 or 0.1..0.9:5")]
        InvalidRange { text: String, fault: RangeFault },
        "sweep.axes" #[error("no parameter varies")]
        #[hint("for example --set body.ball.mass=1,2,4 or --set body.ball.mass=1..4:7")]
        NothingVaries {},
        "sweep.axes" #[error("the parameter varies twice")]
        VariesTwice {},
        "sweep.range" #[error("the range must not give the number of values, because --sample gives the number of points")] #[value("{range}")] #[allowed("{range}")]
        SampleWithCount { range: String },
        "sweep.range" #[error("the range does not give the number of values")] #[value("{range}")] #[allowed("{range}:COUNT, or --sample COUNT")]
        NoCount { range: String },
        "sweep.range" #[error("a sample of 0 points is empty")] #[value("--sample 0")] #[allowed("1 to {most}")]
        #[hint("for example --sample 20")]
        EmptySample { most: usize },
        "sweep.too_many" #[error("the sweep has {count} points")] #[value("{count}")] #[allowed("at most {most}")]
        TooManyPoints { count: String, most: usize },
        "sweep.damaged" #[error("the program cannot read the definition of the sweep: {reason}")] #[hint("--force starts the sweep again")]
        Question { reason: String },
        "sweep.damaged" #[error("the definition of the sweep has version {found}; this program reads version {version}")]
        #[hint("--force starts the sweep again")]
        QuestionVersion { found: u32, version: u32 },
        "sweep.damaged" #[error("the program cannot read the file `{name}` of the sweep")] #[hint("--force starts the sweep again")]
        FileOfSweep { name: String },
        "sweep.damaged" #[error("{fault}")] #[value("{content}")] #[hint("--force starts the sweep again, --out uses another folder")]
        Table { fault: RowFault, content: String },
        "sweep.changed_row" #[error("the row was changed after the sweep wrote it: its checksum differs")] #[value("{content}")]
        #[allowed("the row as it was written")]
        #[hint("delete its line to compute the point again; --force starts the whole sweep again, --out uses another folder")]
        ChangedRow { content: String },
        "write.exists" #[error("the folder contains a different sweep: {difference}")]
        #[hint("--force starts again, --out uses another folder")]
        OtherQuestion { difference: QuestionDifference },
        "write.failed" #[error("a row of the table cannot be written: {reason}")]
        #[hint("the rows before it are kept; repeat the call to continue the sweep")]
        RowNotWritten { reason: String },
        "sweep.metric" #[error("the sweep measures nothing")] #[allowed("--metric {words}, and PROBE.COLUMN.min, .max, .mean, .last")]
        #[hint("for example --metric bounce_height --metric settling_time")]
        NothingMeasured { words: String },
        "sweep.metric" #[error("the metric is given twice")] #[value("{metric}")]
        MetricTwice { metric: String },
        "sweep.metric" #[error("there is no metric `{metric}`")] #[value("{metric}")]
        #[allowed("{words}, and PROBE.COLUMN.min, .max, .mean, .last")]
        NoMetric { metric: String, words: String },
        "sweep.metric" #[error("there is no body `{body}`")] #[value("{metric}")]
        NoBodyToMeasure { body: String, metric: String },
        "sweep.metric" #[error("there is no column `{column}` of a probe")] #[value("{metric}")]
        NoColumn { column: String, metric: String },
        "sweep.metric" #[error("nothing in the scene defines which way is up")] #[value("{metric}")] #[allowed("scenes with gravity or a half-space")]
        NoUp { metric: String },
    }
}

terms! {
    /// What replaces the list of allowed names if a scene has nothing of the requested kind.
    pub enum SweepAllowed = "part.sweep_allowed" { SceneHasNone = "the scene has none" }
}

/// All messages of sweeps, for tests of translations.
#[doc(hidden)]
pub const MESSAGES: &[&[opruga_math::message::Variant]] = &[
    RangeFault::VARIANTS,
    RowFault::VARIANTS,
    SweepError::VARIANTS,
    SweepAllowed::VARIANTS,
    QuestionDifference::VARIANTS,
];

messages! {
    /// The difference between an earlier question of a sweep and the present one.
    #[derive(Clone, Debug, PartialEq)]
    pub enum QuestionDifference {
        "part.question" #[error("the text of the scene was different")]
        Scene {},
        "part.question" #[error("a file that the scene names was different")]
        File {},
        "part.question" #[error("--set {before} instead of {now}")]
        Set { before: String, now: String },
        "part.question" #[error("--metric {before} instead of {now}")]
        Metric { before: String, now: String },
        "part.question" #[error("other points were requested")]
        Points {},
    }
}
