//! Messages for bodies, models and integrators that a world cannot combine.

use opruga_core::error::StepError;
use opruga_math::message::AnyMessage;
use opruga_math::messages;
use opruga_math::words::{number, rounded};

/// The reason why a model lacks something, to be added to the message.
fn because(why: &Option<AnyMessage>) -> String {
    why.as_ref().map_or_else(String::new, |why| format!(": {why}"))
}

messages! {
    /// Reasons why a world refuses a combination.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Refusal {
        "scene.unknown_name" #[error("there is no such model")]
        NoModelHere {},
        "scene.unknown_name" #[error("there is no such integrator")]
        NoIntegratorHere {},
        "scene.unknown_name" #[error("there is no such {what}")] #[allowed("{known}")]
        NoKindHere { what: &'static str, known: String },
        "scene.missing" #[error("`{name}` is missing")] #[parameters(name)]
        NoFieldGiven { name: &'static str },
        "stale_handle" #[error("the body of this handle is no longer in this world, or never was")]
        #[hint("`World::body` finds a body by its name, `World::handle` gives a handle of it")]
        StaleHandle {},
        "model.cells_twice" #[error("cell {cell} belongs to the models {first} and {second} of the body, whose stiffnesses would add up")]
        #[allowed("every cell in one `{kind}` model")] #[hint("use `cells` to name groups without common cells")]
        CellsTwice { cell: u32, first: usize, second: usize, kind: &'static str },
        "model.uncovered_cells"
        #[error("{count} of {cells} cells are in none of the groups {groups} of the models and would have mass but no stiffness; the first is cell {first}")]
        #[allowed("every cell in one model")]
        Uncovered { count: usize, cells: usize, first: usize, groups: String },
        "integrator.mass_matrix"
        #[error("`mass` is \"consistent\", which couples the accelerations of the nodes of a cell, but `{integrator}` moves every node according to its own mass")] #[value("\"consistent\"")] #[parameters("mass")]
        #[allowed("\"lumped\"")] #[hint("consistent masses work with backward_euler, bdf2, implicit_midpoint and newmark")]
        MassMatrix { integrator: &'static str },
        "model.mass" #[error("`mass` is \"consistent\", but there are obstacles, whose impacts act on the masses of single nodes")] #[value("\"consistent\"")] #[parameters("mass")]
        #[allowed("\"lumped\"")] #[hint("`equilibrium` has no impacts and accepts consistent masses with obstacles")]
        MassAndObstacles {},
        "model.mass" #[error("`mass` is \"consistent\", but `node_mass` = {mass} kg gives every node the same mass, whatever its cells")] #[value("\"consistent\"")] #[parameters("mass")]
        #[allowed("\"lumped\"")] #[hint("use `mass` or `density` of the body with consistent masses")]
        NodeMass { mass: f64 },
        "integrator.needs" #[error("the model has no symmetric second derivatives, which `{integrator}` needs{}", because(why))]
        #[hint("use an explicit integrator, such as `symplectic_euler`; `equilibrium` finds where the body comes to rest")]
        NoSymmetry { integrator: String, why: Option<AnyMessage> },
        "integrator.needs" #[error("the model has no second derivatives, which `{integrator}` needs{}", because(why))]
        #[hint("use an explicit integrator, such as `symplectic_euler`")]
        NoDerivatives { integrator: String, why: Option<AnyMessage> },
        "integrator.needs" #[error("`{model}` has no symmetric second derivatives{}", because(why))]
        NoSymmetricModes { model: &'static str, why: Option<AnyMessage> },
        "integrator.needs" #[error("`{model}` has no second derivatives")]
        NoModes { model: &'static str },
        "run.model" #[error("{cause}")]
        State { cause: StepError },
        "modes.all_held" #[error("all nodes of the body are pinned along every axis, so the body cannot vibrate")]
        #[allowed("a node that is free along an axis")] #[hint("choose another body, or use fewer pins")]
        AllHeld {},
        "modes.no_mass" #[error("node {node} has no mass")] #[allowed("masses above 0 where a node can move")]
        NoMassOfNode { node: usize },
        "modes.memory" #[error("{count} modes of a body with {axes} free coordinates need about {bytes} bytes")] #[allowed("at most {most} bytes")]
        #[hint("compute fewer modes")]
        ModesMemory { count: usize, axes: usize, bytes: String, most: String },
        "modes.indefinite" #[error("this state has no natural frequencies, because its stiffness is not finite or is far from positive definite")]
        Indefinite {},
        "contact.implicit" #[error("a body with `{integrator}` cannot touch body `{other}`: one of their integrators finds a state of rest, the other follows a motion")]
        #[allowed("integrators that all find states of rest, or all follow motions")]
        #[hint("`contact.touch = false` of a body lets it pass through the others")]
        RestBesideMotion { integrator: &'static str, other: String },
        "contact.implicit" #[error("`{integrator}` with `arc_length` or `load_steps` applies loads in parts, but bodies that touch are balanced under the whole load")] #[parameters("arc_length", "load_steps")]
        #[allowed("no `arc_length` and no `load_steps` for bodies that touch")]
        #[hint("`contact.touch = false` of a body lets it pass through the others")]
        RestInParts { integrator: &'static str },
        "run.model" #[error("no common equilibrium was found for bodies that touch: even very short steps of the bodies and of their contact do not lead to the same state")]
        #[hint("use pins or friction to hold bodies that would slide")]
        NoAgreementAtRest {},
        "run.model" #[error("no common equilibrium was found for bodies that touch: after {steps} steps towards it, they still move by {} m", number(*moved))]
        #[hint("use pins or friction to hold bodies that would slide")]
        NoCommonBalance { steps: usize, moved: f64 },
        "contact.barrier" #[error("a barrier needs an integrator that solves for the state at the end of a step, which `{integrator}` does not do")]
        #[parameters("response")] #[allowed("an implicit integrator, such as `backward_euler`")] #[hint("`response = \"constraint\"` works with every integrator")]
        NoBarrier { integrator: &'static str },
        "contact.reach"
        #[error("the reach is {} m and the shortest edge of the body is {} m, so neighbouring parts of its surface would push one another apart at rest", number(*reach), number(*shortest))]
        #[parameters("reach")] #[allowed("less than the length of that edge")]
        Reach { reach: f64, shortest: f64 },
        "contact.thickness"
        #[error("the thickness is {} m and the shortest edge of the body is {} m, so neighbouring parts of its surface would push one another apart at rest", number(*thickness), number(*shortest))]
        #[parameters("thickness")] #[allowed("less than the length of that edge")] #[hint("with `contact = {{ self = false }}`, the thickness of the body may be larger")]
        Thickness { thickness: f64, shortest: f64 },
        "contact.thickness"
        #[error("the thickness is {} m, but the body is only {} m large", number(*thickness), number(*size))]
        #[parameters("thickness")] #[allowed("less than the size of the body")]
        ThickerThanBody { thickness: f64, size: f64 },
        "contact.unfold" #[error("`unfold` displaces bodies at random, possibly into other bodies")] #[parameters("unfold")] #[allowed("`unfold = false` in a scene with `[contact]`")]
        Unfold {},
        "limit.memory" #[error("the bodies of the scene need about {all} bytes, of which `{body}` needs {largest}")] #[allowed("at most {most} bytes")]
        #[hint("use a coarser mesh, an explicit integrator, or `linear_solver = \"matrix_free\"`")]
        SceneMemory { all: String, body: String, largest: String, most: u64 },
        "limit.memory" #[error("the bodies of the scene need about {all} bytes, of which `{body}` needs {largest}")]
        #[allowed("the memory that is available to this program")]
        #[hint("use a coarser mesh, an explicit integrator, or `linear_solver = \"matrix_free\"`")]
        MachineMemory { all: String, body: String, largest: String },
        "scene.range"
        #[error("the body begins {} m from the origin along an axis, where positions are rounded by {} m", rounded(*farthest, 3), rounded(*farthest * f64::EPSILON, 2))]
        #[allowed("at most {} m, where rounding is a millionth of the distance between the nodes of the body", rounded(*range, 3))]
        #[hint("move the scene to the origin")]
        FarBody { farthest: f64, range: f64 },
        "scene.range"
        #[error("`velocity` and `angular_velocity` give the body an initial speed of {} m/s along an axis; it would move {} m in a step of {} s", rounded(*fastest, 3), rounded(*fastest * *h, 3), number(*h))] #[parameters("velocity", "angular_velocity")]
        #[allowed("at most {} m/s, so that after a step the positions of the nodes still have enough digits to differ", rounded(*range / *h, 3))]
        #[hint("are the units mixed (metres, seconds, radians)?")]
        FastBody { fastest: f64, h: f64, range: f64 },
        "scene.range" #[error("`{word}` is {value}, which gives node {node} a mass of {} kg", number(*mass))] #[value("{value}")] #[parameters(word)]
        #[allowed("values that give every node a mass of at least {} kg and at most {} kg", number(f64::MIN_POSITIVE), number(f64::MAX))]
        #[hint("are the units mixed (metres, kilograms)?")]
        MassOfNode { word: &'static str, value: String, node: usize, mass: f64 },
        "scene.range" #[error("gravity of {} m/s² takes the energy of the bodies out of the range of finite numbers", number(*weight))]
        #[allowed("at most {} m/s² along an axis", number(*most))]
        Weight { weight: f64, most: f64 },
        "scene.range" #[error("`{word}` is {value}, which takes the energy or the momentum of the body out of the range of finite numbers")] #[value("{value}")] #[parameters(word)]
        #[allowed("numbers whose squares are finite, up to {}", number(*most))]
        BeyondFinite { word: &'static str, value: String, most: f64 },
        "scene.range" #[error("the energy or the momentum of the body is out of the range of finite numbers")]
        #[hint("are the units mixed (metres, kilograms, seconds)?")]
        Sums {},
        "step.not_finite" #[error("{cause}")]
        #[allowed("forces, stiffnesses and their ratios to the masses of nodes below 1e300")]
        #[hint("the lightest node of the body has a mass of {} kg", number(*lightest))]
        NoEstimate { cause: AnyMessage, lightest: f64 },
        "step.not_finite" #[error("{cause}")]
        #[allowed("forces, stiffnesses and their ratios to the masses of nodes below 1e300")]
        #[hint("the largest number in the models of the body is `{field}` = {} of `{kind}`, and its lightest node has a mass of {} kg", number(*value), number(*lightest))]
        NoEstimateOf { cause: AnyMessage, field: String, value: f64, kind: String, lightest: f64 },
        "run.model" #[error("obstacles push nodes through surfaces, although a barrier should prevent this")] #[hint("use smaller steps, or finer surfaces")]
        Pushed {},
        "run.model" #[error("cell {cell} is inverted (volume ratio {}) while a barrier keeps bodies apart", number(*ratio))]
        #[hint("use a material that resists inversion, such as `neo_hookean`, or smaller steps")]
        InvertedByBarrier { cell: u32, ratio: f64 },
        "run.model" #[error("the matrix of a step with a barrier cannot be factored: it is not positive definite")] #[hint("use smaller steps, or another material")]
        NoFactor {},
        "run.model" #[error("the step of bodies that a barrier keeps apart did not converge in {iterations} iterations")]
        #[hint("use smaller steps, or more `iterations`")]
        NoCommonEnd { iterations: u32 },
    }
}
