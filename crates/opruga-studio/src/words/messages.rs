//! The texts of messages.

use super::{Language, Part};
use crate::differences::Difference;
use crate::exploded::Exploded;
use crate::report::{Report, Step};
use opruga::core::spec::Value;
use opruga::draw::ArrowKind;

/// Chooses between a sentence in English and one in Croatian.
macro_rules! either {
    ($language:expr, $english:literal, $croatian:literal) => {
        match $language {
            Language::English => format!($english),
            Language::Croatian => format!($croatian),
        }
    };
}

impl Language {
    /// The name of an action that can be undone, in a word or two.
    pub fn done(self, step: &Step) -> String {
        match step {
            // The last name of a path is the field; the rest is visible in the panel.
            Step::Set(path) | Step::Differ(path) => self.field_word(path.rsplit('.').next().unwrap_or(path)),
            Step::Shape(field) => self.field_word(field),
            Step::Models => self.step_models().into(),
            Step::Integrator => self.step_integrator().into(),
            Step::Add => self.step_add().into(),
            Step::Duplicate => self.step_duplicate().into(),
            Step::Move => self.step_move().into(),
            Step::Turn => self.step_turn().into(),
            Step::Contact => self.contact().into(),
            Step::Scale => self.step_scale().into(),
            Step::Delete => self.step_delete().into(),
            Step::Open(name) => format!("{} {name}", self.step_open()),
            Step::Pull => self.step_pull().into(),
            Step::Push => self.step_push().into(),
            Step::Pin => self.step_pin().into(),
            Step::Unpin => self.step_unpin().into(),
            Step::Reset => self.step_reset().into(),
            Step::Compare => self.step_compare().into(),
        }
    }

    /// The meaning of a kind of arrow.
    pub fn arrow(self, kind: ArrowKind) -> &'static str {
        match kind {
            ArrowKind::Velocity => self.arrow_of_velocity(),
            ArrowKind::Normal => self.arrow_of_normal(),
            ArrowKind::Contact => self.arrow_of_contact(),
            ArrowKind::Pressure => self.arrow_of_pressure(),
            _ => self.arrow_of_force(),
        }
    }

    /// A few words for the picture that name a difference of the right side.
    pub fn difference(self, difference: &Difference) -> String {
        let named = |field: &str, value: &Value| match value {
            Value::Number(x) => format!("{} {}", self.field_word(field), opruga::draw::format_value(*x)),
            Value::Text(word) => format!("{} {}", self.field_word(field), self.choice(word)),
            value => format!("{} {value}", self.field_word(field)),
        };
        match difference {
            Difference::Set(path, value) => named(path.split('.').next_back().unwrap_or_default(), value),
            Difference::Shape(_, field, value) => named(field, value),
            Difference::Models(_, models) => {
                models.iter().map(|model| self.kind(Part::Model, model.kind())).collect::<Vec<_>>().join(" + ")
            }
            Difference::Integrator(_, values) => self.kind(Part::Integrator, values.kind()),
        }
    }

    /// The text of a report.
    #[expect(clippy::too_many_lines, reason = "a table: one arm for every message")]
    pub fn report(self, report: &Report) -> String {
        match report {
            Report::Scene(errors) => {
                errors.iter().map(|error| error.text(self.translation())).collect::<Vec<_>>().join("\n")
            }
            Report::World(error) => self.in_full(error),
            Report::Recording(error) => self.in_full(error),
            Report::NotWritten(error) => error.text(self.translation()),
            Report::NotDrawn(error) => self.in_full(error),
            Report::Inside(file, report) => format!("{file}: {}", self.report(report)),
            Report::NotCompressed => {
                either!(self, "the scene cannot be compressed", "prizor se ne može sažeti")
            }
            Report::Exploded(Exploded { body, integrator, unstable: true }) => {
                let integrator = self.kind(Part::Integrator, integrator);
                either!(
                    self,
                    "`{body}` exploded: {integrator} is unstable at this step",
                    "Tijelo `{body}` se raspalo: {integrator} je nestabilan uz ovaj korak"
                )
            }
            Report::Exploded(Exploded { body, .. }) => either!(
                self,
                "`{body}` exploded: it has grown to more than 100 times the initial size of the scene",
                "Tijelo `{body}` se raspalo: više je od 100 puta veće nego što je bio prizor"
            ),
            Report::Undone(step, time) => format!("{} {}, t = {time:.2} s", self.undone(), self.done(step)),
            Report::Redone(step, time) => format!("{} {}, t = {time:.2} s", self.redone(), self.done(step)),
            Report::PinsLetGo => self.pins_let_go().into(),
            Report::GoesOn(name) => format!("`{name}` {}", self.goes_on()),
            Report::AllGoOn(kind) => format!("{} `{}`", self.all_go_on(), self.kind(Part::Integrator, kind)),
            Report::SetDown => self.set_down().into(),
            Report::AtTheStartAlone(path) => {
                let name = self.done(&Step::Set(path.clone()));
                either!(
                    self,
                    "`{name}` can be removed only at the start: press Reset, then ×",
                    "`{name}` se može izostaviti samo na početku: „Na početak”, pa ×"
                )
            }
            Report::ContactAtTheStartAlone => either!(
                self,
                "Contact can be switched on and off only at the start: press Reset first",
                "Dodir se uključuje i isključuje samo na početku: najprije „Na početak”"
            ),
            Report::AtTheEnd(time, list) => {
                let list: Vec<String> = list.iter().map(|warning| self.warning_text(warning)).collect();
                let (count, list) = (list.len(), list.join(" · "));
                let warnings = if count == 1 { "1 warning".into() } else { format!("{count} warnings") };
                either!(
                    self,
                    "On the command line, the run ends here, at t = {time:.2} s, with {warnings}: {list}. In the window, time continues",
                    "Naredbeni redak ovdje završava, u t = {time:.2} s; upozorenja ({count}): {list}. U prozoru vrijeme teče dalje"
                )
            }
            Report::RecordingEnds(time) => either!(
                self,
                "The recording ends here, at t = {time:.2} s. What follows is computed as a new run",
                "Snimka ovdje završava, u t = {time:.2} s. Što slijedi tek se računa: to je novi tijek"
            ),
            Report::OwnCourse(time) => either!(
                self,
                "From t = {time:.2} s on, this is a new run; the recorded file does not change",
                "Od t = {time:.2} s ovo je novi tijek; datoteka snimke ostaje kakva jest"
            ),
            Report::TakesLong(seconds) => either!(
                self,
                "A frame takes longer than {seconds} s, and the page cannot respond in the meantime. Time has stopped at the last good frame. \
                 Fewer substeps or vertices make a frame faster. The desktop studio and `opruga run` do not have this limit",
                "Sličica traje dulje od {seconds} s, a dotle se ništa ne može tražiti: vrijeme stoji na zadnjoj dobroj sličici. \
                 Manje podkoraka ili vrhova traje kraće; program s prozorom i `opruga run` nisu time vezani"
            ),
            Report::NoBody(name) => either!(self, "there is no body `{name}`", "nema tijela `{name}`"),
            Report::NoShape(name) => {
                either!(self, "body `{name}` has no shape to change", "tijelo `{name}` nema oblik koji bi se mijenjao")
            }
            Report::Copy(name) => either!(
                self,
                "`{name}` is one of several copies; remove `copies` from the scene to change them one by one",
                "`{name}` je jedna od više kopija; ukloni `copies` iz prizora da ih mijenjaš jednu po jednu"
            ),
            Report::Scaled(by) => either!(
                self,
                "a body cannot be scaled by {by}; allowed: factors above 0",
                "tijelo se ne može povećati {by} puta; dopušteno: više od 0"
            ),
            Report::NoDifference(about) => either!(
                self,
                "The scene itself does not contain `{about}`. The two sides can differ only in bodies that exist from the start and are not \
                 copies",
                "`{about}` ne stoji u samom prizoru; strane se mogu razlikovati u tijelima koja su ondje od početka i nisu kopije"
            ),
            Report::NoText(file) => either!(self, "{file} is not UTF-8 text", "{file} nije tekst u UTF-8"),
            Report::NoShapeFile(file, known) => either!(
                self,
                "{file} is neither a scene nor a shape; allowed: {known}",
                "{file} nije ni prizor ni oblik; dopušteno: {known}"
            ),
            Report::NameOfFile(file) => either!(
                self,
                "{file}: a scene cannot refer to a file with this name; rename it without quotes and backslashes",
                "{file}: prizor ne može imenovati tu datoteku; preimenuj je bez navodnika i obrnutih kosih crta"
            ),
            Report::TooLarge(file, bytes, most) => either!(
                self,
                "{file} has {bytes} bytes; allowed: at most {most}",
                "{file} ima {bytes} bajtova; dopušteno: najviše {most}"
            ),
            Report::Unreadable(file) => either!(self, "{file} cannot be read", "{file} se ne može pročitati"),
            Report::Written(files) => format!("{} {}", self.kept(), files.join(", ")),
            Report::NoFolder(folder, why) => {
                either!(self, "the folder {folder} cannot be created: {why}", "mapa {folder} ne može nastati: {why}")
            }
            Report::FolderFull(folder) => either!(self, "{folder} is full", "mapa {folder} je puna"),
            Report::NoDownload(file) => {
                either!(self, "the browser does not accept the file {file}", "preglednik ne prima datoteku {file}")
            }
            Report::NothingToDraw => either!(self, "there is nothing to draw", "nema se što nacrtati"),
            Report::LinkCopied => self.link_copied().into(),
            Report::AddressTooLong(letters, most) => either!(
                self,
                "the scene is too large for a link ({letters} characters; at most {most} are allowed). Save it as a file instead",
                "prizor je prevelik za adresu: {letters} znakova; dopušteno: {most}. Spremi ga kao datoteku"
            ),
            Report::AddressUnknown(known) => either!(
                self,
                "the address names no scene that comes with the program; allowed: {known}",
                "adresa ne imenuje nijedan prizor iz programa; dopušteno: {known}"
            ),
            Report::AddressCut => either!(
                self,
                "the scene in the address is not complete: the address may have been cut off when it was copied",
                "prizor u adresi nije cjelovit: adresa je možda odrezana pri kopiranju"
            ),
            Report::AddressTooLarge(most) => either!(
                self,
                "the scene in the address is too large; allowed: at most {most} bytes",
                "prizor u adresi je prevelik; dopušteno: {most} bajtova"
            ),
            Report::WindowLost(file) => either!(
                self,
                "The previous window was lost, probably because of the graphics driver. Your work is saved in {file}. The scene continues here from \
the last saved moment",
                "Posljednji prozor je izgubljen, vjerojatno s grafičkim upravljačkim programom. Učinjeno je spremljeno u {file} i \
                 nastavlja se ovdje: vrijeme stoji na zadnjem sačuvanom trenutku"
            ),
            Report::AddressStays => {
                either!(
                    self,
                    "the browser does not allow the address of the page to be changed",
                    "preglednik ne da mijenjati svoju adresu"
                )
            }
        }
    }

    /// The name of a quantity in the legend of a picture.
    pub fn quantity(self, label: &str) -> &str {
        match (self, label) {
            (Language::English, label) => label,
            (Language::Croatian, "strain") => "deformacija",
            (Language::Croatian, "elastic force") => "elastična sila",
            (Language::Croatian, "pressure") => "tlak",
            (Language::Croatian, "speed") => "brzina",
            (Language::Croatian, "von Mises stress") => "naprezanje (von Mises)",
            (Language::Croatian, "volume / volume at rest") => "obujam / početni",
            (Language::Croatian, label) => label,
        }
    }
}
