//! All texts of the interface in all languages, in one place.

mod messages;
mod named;
mod scene_titles;

pub use named::Part;
use opruga::math::message::Message;
use opruga::words::Translation;

/// A language of the interface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Language {
    /// English.
    #[default]
    English,
    /// Croatian.
    Croatian,
}

impl Language {
    /// All languages.
    pub const EVERY: [Language; 2] = [Language::English, Language::Croatian];

    /// The translation of the engine's texts; none for English, which is the language of the engine.
    pub fn translation(self) -> Option<&'static Translation> {
        match self {
            Language::English => None,
            Language::Croatian => Some(Translation::croatian()),
        }
    }

    /// The full text of a message of the engine: the message itself, the allowed values and a hint. If there is no translation, the text is in
    /// English.
    pub fn in_full(self, message: &dyn Message) -> String {
        self.translation().and_then(|known| known.in_full(message)).unwrap_or_else(|| message.in_full())
    }

    /// The two-letter code of the language in ISO 639.
    pub fn code(self) -> &'static str {
        match self {
            Language::English => "en",
            Language::Croatian => "hr",
        }
    }
}

macro_rules! words {
    ($($(#[$about:meta])* $name:ident: $english:literal, $croatian:literal;)*) => {
        impl Language {
            $(
                #[doc = $english]
                pub fn $name(self) -> &'static str {
                    match self {
                        Language::English => $english,
                        Language::Croatian => $croatian,
                    }
                }
            )*
        }
        /// All texts in all languages, for tests.
        pub const ALL: &[(&str, &str, &str)] = &[$((stringify!($name), $english, $croatian)),*];
    };
}

words! {
    scenes: "Scenes", "Prizori";
    scenes_hint: "Open one of the scenes that come with the program", "Otvori jedan od prizora iz programa";
    save: "Save", "Spremi";
    undo: "Undo", "Poništi";
    redo: "Redo", "Ponovi";
    play: "Play", "Pokreni";
    pause: "Pause", "Zaustavi";
    step: "Step", "Korak";
    step_hint: "Advance by one frame", "Jedna sličica";
    reset: "Reset", "Na početak";
    reset_hint: "Go back to the start and discard everything you have done since", "Na početak, bez svega što je u međuvremenu učinjeno";
    replay: "Replay", "Ponovi snimku";
    replay_hint: "Go back to the start and replay everything you have done since", "Na početak: sve se učinjeno događa opet";
    speed: "Speed", "Brzina";
    speed_hint: "Simulated seconds per real second", "Simuliranih sekundi u stvarnoj sekundi";
    time: "Time", "Vrijeme";
    rewind_hint: "Go back and forth in time", "Kretanje kroz vrijeme";
    keep: "Export", "Izvezi";
    save_scene: "Scene with everything you have done (.toml)", "Prizor sa svime što je učinjeno (.toml)";
    screenshot: "Picture (.png)", "Slika (.png)";
    film: "Film (.mp4)", "Film (.mp4)";
    animation: "Animation (.gif)", "Animacija (.gif)";
    table: "Table of all frames (.csv)", "Tablica svih sličica (.csv)";
    kept: "Written:", "Zapisano:";
    copy_link: "Copy a link with the whole scene", "Kopiraj poveznicu s cijelim prizorom";
    link_copied: "The link has been copied; it is also in the address bar", "Poveznica je kopirana i stoji u adresnoj traci";
    open_file: "Open a file …", "Otvori datoteku …";
    working: "Computing the scene again for the file …", "Prizor se računa ponovno za datoteku …";
    language: "Hrvatski", "English";
    dark: "Dark", "Tamno";
    light: "Light", "Svijetlo";
    close_question: "`{}` has changed since it was opened or saved. Save it before the window closes?", "Prizor `{}` mijenjan je otkako je otvoren ili spremljen. Spremiti ga prije zatvaranja prozora?";
    discard: "Discard", "Odbaci";
    cancel: "Cancel", "Odustani";
    help: "Help", "Pomoć";
    close: "Close", "Zatvori";
    pull: "Pull", "Vuci";
    pull_hint: "Press a body and drag it", "Pritisni tijelo i povuci ga";
    push: "Push", "Guraj";
    push_hint: "Press a body and drag: the force grows with the distance that you drag", "Pritisni tijelo: sila raste s pomakom pokazivača";
    pin: "Pin", "Pribodi";
    pin_hint: "Press a body to pin a point. Drag a pinned point to move it; double-click the point to free it", "Pritisni tijelo da se točka drži; pridržanu točku pomakni, dvostrukim klikom oslobodi";
    shift: "Move", "Pomakni";
    shift_hint: "Drag a body to another position, or turn and scale it with its handles; the body then starts there, at rest", "Odvuci tijelo drugamo ili ga ručkama zakreni i povećaj: ondje se postavlja u mirovanju";
    draw: "Draw", "Crtaj";
    draw_hint: "Draw a closed outline: it becomes a body", "Nacrtaj zatvoreni obris: postaje tijelo";
    add: "Add", "Dodaj";
    add_hint: "Shapes that become bodies", "Oblici koji postaju tijela";
    of_ball: "ball", "lopta";
    of_big_ball: "big ball", "velika lopta";
    of_square: "square", "kvadrat";
    of_triangle: "triangle", "trokut";
    of_jelly: "jelly", "žele";
    of_rope: "rope", "uže";
    of_balloon: "balloon", "balon";
    of_tube: "tube", "zračnica";
    of_cloth: "cloth", "tkanina";
    fit: "Fit", "Sve u kadar";
    fit_hint: "Show everything", "Prikaži sve";
    colour: "Colour", "Boja";
    overlays: "Show", "Prikaz";
    arrows: "Pressure and forces", "Tlak i sile";
    springs: "Springs", "Opruge";
    vertices: "Vertices", "Vrhovi";
    velocities: "Velocities", "Brzine";
    normals: "Normals", "Normale";
    contact: "Contact", "Dodir";
    bodies_touch: "Bodies touch one another", "Tijela se dodiruju";
    bodies_touch_hint: "Without contact, bodies pass through one another. Contact can be switched on and off only at the start", "Bez dodira tijela prolaze jedno kroz drugo. Uključuje se i isključuje samo na početku";
    contacts: "Contact forces", "Sile dodira";
    arrow_of_velocity: "velocity", "brzina";
    arrow_of_normal: "normal", "normala";
    arrow_of_contact: "contact force", "sila dodira";
    arrow_of_pressure: "pressure", "tlak";
    arrow_of_force: "force", "sila";
    contacts_hint: "Forces of obstacles and other bodies on the nodes: normal force, friction, and the impulse of an impact divided by the duration of a step", "Prepreka i drugih tijela na čvorove: normalna sila, trenje i impuls sudara kroz trajanje koraka";
    colour_map: "Colours", "Boje";
    viridis: "Violet to yellow", "Ljubičasto do žuto";
    embers: "Pale to dark violet", "Blijedo do tamnoljubičasto";
    cividis: "Blue to yellow, for red-green blindness", "Plavo do žuto, za daltoniste";
    grey: "Grey, without colours", "Sivo, bez boja";
    diverging: "Blue to red", "Plavo do crveno";
    elastic_force_hint: "The force of springs, bending or finite elements on each node [N]", "Sila opruga, savijanja ili konačnih elemenata na svaki čvor [N]";
    von_mises_hint: "Stress in solids [Pa]; springs have no such stress, but they have an elastic force", "Naprezanje u čvrstim tijelima [Pa]; opruge ga nemaju: vidi elastičnu silu";
    pressure_hint: "Pressure of the gas in each body [Pa]; bodies without gas have no value", "Plina u cijelom tijelu [Pa]; tijela bez plina ga nemaju";
    compare: "Side by side", "Usporedi";
    compare_hint: "Run the same scene twice, side by side in lock step. The right side has another model, integrator or parameter", "Isti prizor dvaput, korak po korak: desno s drugim modelom, integratorom ili parametrom";
    both_sides: "Both", "Obje strane";
    both_sides_hint: "Changes made here apply to both sides", "Promjene vrijede za obje strane";
    right_only: "Right only", "Samo desno";
    right_only_hint: "Changes made here apply to the right side only, from the start of the scene", "Promjene su razlike desne strane, od početka";
    as_it_is: "as in the scene", "prizor kakav jest";
    no_difference: "no difference yet: choose “Right only” and change something", "još bez razlike: odaberi „Samo desno” i promijeni nešto";
    mean_distance: "mean distance", "srednja udaljenost";
    largest_distance: "largest", "najveća";
    distance_of_sides: "Distance between the sides [m]", "Udaljenost strana [m]";
    center_distance: "centres of mass", "težišta";
    volume_of_sides: "Enclosed volume, right − left", "Zatvoreno, desno − lijevo";
    energy_of_sides: "Energy, right − left [J]", "Energija, desno − lijevo [J]";
    right_stopped: "The right side has stopped:", "Desna strana ne ide dalje:";
    properties: "Properties", "Svojstva";
    focus: "Focus", "Na tijelo";
    focus_hint: "Show only the selected body", "Prikaži samo odabrano tijelo";
    strain: "Strain", "Deformacija";
    elastic_force: "Elastic force", "Elastična sila";
    von_mises_stress: "Von Mises stress", "Naprezanje po von Misesu";
    volume_ratio: "Volume / volume at rest", "Obujam prema početnome";
    pressure: "Pressure", "Tlak";
    speed_of_nodes: "Speed of nodes", "Brzina čvorova";
    plain: "Plain", "Jednobojno";
    body: "Body", "Tijelo";
    world: "World", "Svijet";
    obstacle: "Obstacle", "Prepreka";
    models: "Models", "Modeli";
    integrator: "Integrator", "Integrator";
    of_the_scene: "that of the scene", "kao u prizoru";
    add_model: "Add a model", "Dodaj model";
    remove_model: "Remove this model", "Ukloni ovaj model";
    remove_value: "Remove this value", "Ne zadaj više";
    instead: "{} instead of {}", "{} (umjesto: {})";
    shape: "Shape", "Oblik";
    turn: "Turn", "Zakreni";
    scale: "Larger", "Povećaj";
    smaller: "Smaller", "Smanji";
    duplicate: "Duplicate", "Udvostruči";
    delete: "Delete", "Izbriši";
    gravity: "Gravity", "Gravitacija";
    gravity_hint: "Drag the end of the arrow", "Povuci vrh strelice";
    drag: "Air drag", "Otpor zraka";
    substeps: "Substeps", "Podkoraci";
    substeps_hint: "Steps of the integrator per frame: fewer are faster, too few are unstable", "Koraka integratora u sličici: manje je brže, premalo je nestabilno";
    stable: "stable from", "stabilno od";
    state_hash: "State hash", "Sažetak stanja";
    state_hash_hint: "Hash of the bits of all positions and velocities; `opruga run --json` reports the same hash (`state_hash`) for this frame of the saved scene", "Svih položaja i brzina, bit po bit: isti javlja `opruga run --json` (`state_hash`) za ovu sličicu spremljenog prizora";
    copy: "Copy", "Kopiraj";
    nodes: "nodes", "čvorova";
    nothing_selected: "Press a body to see and change its physics", "Pritisni tijelo da vidiš i promijeniš njegovu fiziku";
    crowd: "If there are more than 64 bodies, they are not listed one by one", "Kad ih je više od 64, tijela se ne navode pojedinačno";
    plots: "Plots", "Grafovi";
    energy: "Energy [J]", "Energija [J]";
    gas: "Volume and pressure", "Obujam i tlak";
    momentum: "Momentum [kg m/s]", "Količina gibanja [kg m/s]";
    step_time: "Computing time [ms]", "Vrijeme računanja [ms]";
    kinetic: "kinetic", "kinetička";
    elastic: "elastic", "elastična";
    of_gas: "gas", "plin";
    of_gravity: "gravity", "gravitacijska";
    work: "work put in", "uloženi rad";
    losses: "losses", "gubici";
    numerical_damping: "damping by the integrator", "prigušenje integratora";
    integration_error: "integration error", "pogreška integracije";
    drag_me: "drag me", "povuci me";
    away: "the bodies are this way: show them (F)", "tijela su onamo: prikaži ih (F)";
    drop_here: "Drop a scene, SVG, OBJ, STL, PLY or glTF here", "Ispusti ovdje prizor, SVG, OBJ, STL, PLY ili glTF";
    slower: "slower than real time", "sporije od stvarnog vremena";
    real_time: "real time", "stvarno vrijeme";
    steps_a_second: "steps/s", "koraka/s";
    margin: "step / stable limit", "korak / granica stabilnosti";
    halve_step: "Go back a second and halve the step", "Vrati se sekundu i prepolovi korak";
    take_steady: "Go back a second and use {}", "Vrati se sekundu i uzmi integrator „{}”";
    use_substeps: "Use {} substeps, with a safety margin", "Uzmi {} podkoraka, s rezervom";
    take_coarser: "Use {} instead, with enough substeps", "Uzmi radije {}, s podkoracima za to";
    frame_would_take: "With that many substeps, a frame takes about {} s", "S toliko podkoraka sličica traje oko {} s";
    computing: "computing this frame: {} s so far", "sličica se računa {} s";
    nothing_has_it: "no body here has this quantity: {}", "ovdje nema veličine: {}";
    again: "recomputing up to t = {} s", "ponovno računanje do {} s";
    on_the_right: "right", "desno";
    crossing: "The outline crosses itself: draw it without crossings", "Obris siječe sam sebe: nacrtaj ga bez križanja";
    too_small: "The outline is too small to be a body", "Obris je premalen da bude tijelo";
    only_plane: "Outlines can be drawn only in 2D scenes", "Obrisi se crtaju u ravninskim prizorima";
    own_colours: "As drawn", "Kako je nacrtano";
    own_colours_hint: "For bodies that carry a drawing, show the colours of the drawing", "Tijela koja nose crtež, u njegovim bojama";
    step_models: "models", "modeli";
    step_integrator: "integrator", "integrator";
    step_add: "new body", "novo tijelo";
    step_duplicate: "copy", "kopija";
    step_move: "move", "pomak";
    step_turn: "turn", "zakret";
    step_scale: "scaling", "promjena veličine";
    step_delete: "delete", "brisanje";
    step_pull: "pull", "povlačenje";
    step_push: "push", "guranje";
    step_pin: "pin a point", "pribadanje točke";
    step_unpin: "free a point", "oslobađanje točke";
    step_reset: "reset", "povratak na početak";
    step_open: "back to", "natrag na";
    step_compare: "side by side", "usporedba";
    undone: "Undone:", "Poništeno:";
    redone: "Redone:", "Ponovljeno:";
    pins_let_go: "The scene was restarted; pins set with the pointer were removed", "Prizor počinje iznova: točke pribodene pokazivačem oslobođene su";
    goes_on: "continues to move: it keeps its positions and velocities, and models that it already had keep their state", "nastavlja u pokretu: položaji i brzine ostaju, a modeli koje je već imalo pamte svoje";
    all_go_on: "Every body continues from its present state with", "Svako tijelo nastavlja odande gdje jest s";
    set_down: "The body starts again at rest, in its new shape", "Tijelo je postavljeno iznova, u mirovanju, u novom obliku";
    recorded: "recorded commands", "snimljene naredbe";
    drawn_by: "The graphics interface and its device", "Čime se crta, i na kojem uređaju";
    in_the_scene: "This can be set only in the scene file", "Zadaje se samo u datoteci prizora";
    yes: "yes", "da";
    no: "no", "ne";
    unsaid: "default", "inače";
    go_on: "Continue as a new run", "Nastavi kao novi tijek";
    wait_longer: "Wait for up to {} s", "Čekaj do {} s";
    recording_until: "recording until", "snimka do";
    recording_hint: "Everything up to the mark was recorded; everything after it was computed later", "Do oznake je ono što je snimljeno; što je iza nje izračunato je poslije";
    warning: "Warning", "Upozorenje";
    pictures_pending: "drawing …", "crta se …";
    shortcuts: "Space\tplay or pause\n→   Home\tone frame; reset\nCtrl Z   Ctrl Y\tundo, redo\nCtrl S\tsave the scene\n1 2 3 4 5\tpull, push, pin, move, draw\nDel   Ctrl D\tdelete the body; duplicate it\n[ ]   + −\tturn the body; scale it\nF   C\tshow everything; the selected body\nP   G   B\tplots; scenes; side by side\nWheel\tzoom\nDrag next to the bodies\tmove the view; in space, turn it\nMiddle drag, Space drag\tmove the view\nRight drag\tpush\nShift drag, double click\tpin a point; free it\nOne finger, two fingers\tpull; zoom and move the view\nEsc\tclose a message\n?\tthis help", "Razmaknica\tpokreni ili zaustavi\n→   Home\tjedna sličica; na početak\nCtrl Z   Ctrl Y\tponišti, ponovi\nCtrl S\tspremi prizor\n1 2 3 4 5\tvuci, guraj, pribodi, pomakni, crtaj\nDel   Ctrl D\tizbriši tijelo; udvostruči ga\n[ ]   + −\tzakreni tijelo; povećaj, smanji\nF   C\tsve u kadar; odabrano tijelo\nP   G   B\tgrafovi; prizori; usporedi\nKotačić\tpribliži\nPovuci pokraj tijela\tpomakni pogled; u prostoru ga okreni\nSrednja tipka, razmaknica\tpomakni pogled\nDesna tipka\tguraj\nShift, dvostruki klik\tpribodi točku; oslobodi je\nJedan prst, dva prsta\tvuci; približi i pomakni pogled\nEsc\tskloni poruku\n?\tova pomoć";
}

#[cfg(test)]
mod tests {
    use super::ALL;

    #[test]
    fn every_word_is_there_in_every_language() {
        for (name, english, croatian) in ALL {
            assert!(!english.is_empty() && !croatian.is_empty(), "{name}");
            assert_eq!(english.contains('…'), croatian.contains('…'), "{name}");
            assert_eq!(english.lines().count(), croatian.lines().count(), "{name}");
        }
    }
}
