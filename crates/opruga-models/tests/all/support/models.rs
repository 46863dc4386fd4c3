//! The models as the library compiles them. A test that names the type of a model would compile all its kernels again.

use opruga_core::error::BuildError;
use opruga_core::memory::{Counts, Need};
use opruga_core::potential::{Ingredients, Model, Potential, Views};
use opruga_core::spec::Spec;

fn compiled<const D: usize>(kind: &str) -> Box<dyn Model<D>> {
    opruga_models::all().into_iter().find(|model| model.spec().kind == kind).expect("a model of the library")
}

macro_rules! models {
    ($($type:ident $kind:literal)*) => {$(
        #[derive(Clone, Copy)]
        pub(crate) struct $type;
        impl<const D: usize> Model<D> for $type {
            fn spec(&self) -> &'static Spec {
                compiled::<D>($kind).spec()
            }
            fn views(&self) -> Views {
                compiled::<D>($kind).views()
            }
            fn need(&self, counts: &Counts) -> Need {
                compiled::<D>($kind).need(counts)
            }
            fn build(&self, ingredients: &Ingredients<D>) -> Result<Box<dyn Potential<D>>, BuildError> {
                compiled::<D>($kind).build(ingredients)
            }
        }
    )*};
}
models! {
    AsPublished "as_published"
    Bending "bending"
    BoundaryElement "boundary_element"
    Drag "drag"
    Fem "fem"
    FiniteDifference "finite_difference"
    FiniteVolume "finite_volume"
    MassSpring "mass_spring"
    Pressure "pressure"
    ShapeMatching "shape_matching"
}
