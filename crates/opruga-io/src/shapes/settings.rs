//! Parameters of shapes, with the values that several hints name.

use opruga_math::message::Setting;

/// Triangles or tetrahedra of a regular grid.
pub(super) fn lattice() -> Setting {
    Setting::with("filling", "\"lattice\"")
}

/// The region that at least one of several areas covers.
pub(super) fn union() -> Setting {
    Setting::with("overlap", "\"union\"")
}

/// The region that lies inside an odd number of areas.
pub(super) fn parity() -> Setting {
    Setting::with("overlap", "\"even_odd\"")
}

/// An open surface is closed.
pub(super) fn cap() -> Setting {
    Setting::with("open", "\"cap\"")
}

/// An open surface stays open.
pub(super) fn sheet() -> Setting {
    Setting::with("open", "\"sheet\"")
}
