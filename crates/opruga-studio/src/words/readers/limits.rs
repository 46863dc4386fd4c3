//! How much a file may ask for, and what its numbers have rounded away, in Croatian.

pub(super) const SENTENCES: &[(&str, &str)] = &[
    ("the file asks for {} closed outlines or more", "datoteka traži zatvorenih obrisa: {} ili više"),
    ("the file asks for {} points of outlines or more", "datoteka traži točaka obrisa: {} ili više"),
    ("the file asks for {} pixels or more", "datoteka traži piksela: {} ili više"),
    ("the file asks for {} elements of a drawing or more", "datoteka traži elemenata crteža: {} ili više"),
    ("the file asks for {} bytes of repeated text or more", "datoteka traži bajtova ponovljenog teksta: {} ili više"),
    (
        "the file asks for {} comparisons of rules with elements or more",
        "datoteka traži usporedaba pravila s elementima: {} ili više",
    ),
    ("the file asks for {} repeated vertices or more", "datoteka traži ponovljenih vrhova: {} ili više"),
    ("the file asks for {} numbers in arrays or more", "datoteka traži brojeva u poljima: {} ili više"),
    (
        "the file asks for {} values or memberships in groups or more",
        "datoteka traži vrijednosti ili pripadnosti skupinama: {} ili više",
    ),
    ("at most {} closed outlines", "najviše {} zatvorenih obrisa"),
    ("at most {} points of outlines", "najviše {} točaka obrisa"),
    ("at most {} elements of a drawing", "najviše {} elemenata crteža"),
    ("at most {} bytes of repeated text", "najviše {} bajtova ponovljenog teksta"),
    ("at most {} comparisons of rules with elements", "najviše {} usporedaba pravila s elementima"),
    ("at most {} repeated vertices", "najviše {} ponovljenih vrhova"),
    ("at most {} numbers in arrays", "najviše {} brojeva u poljima"),
    ("at most {} values or memberships in groups", "najviše {} vrijednosti ili pripadnosti skupinama"),
    (
        "take a picture with fewer spots: one that is smoothed, or drawn with fewer colours",
        "uzmi sliku s manje mrlja: zaglađenu ili nacrtanu s manje boja",
    ),
    ("take a larger `spacing`, or a drawing of fewer points", "uzmi veći `spacing` ili crtež s manje točaka"),
    ("write the drawing without entities, or with `use`", "napiši crtež bez entiteta ili s elementom `use`"),
    ("the letters of this font are made of too many others", "slova ovog fonta sastavljena su od previše drugih"),
    (
        "draw a mesh less often, or leave out what the body does not need",
        "nacrtaj mrežu manje puta ili izostavi što tijelu ne treba",
    ),
    ("save the file without compression", "spremi datoteku bez sažimanja"),
    ("draw the outline with fewer points", "nacrtaj obris s manje točaka"),
    (
        "the head of the section is wrong, or what it tells of is missing",
        "zaglavlje odjeljka je krivo ili nedostaje ono što navodi",
    ),
    ("nodes {} m apart would be {}", "čvorova na razmaku od {} m bilo bi {}"),
    ("from {} m on: at most {} nodes", "od {} m naviše: najviše {} čvorova"),
    ("node {} has two parents, or is its own", "čvor {} ima dva roditelja ili je sam svoj"),
    ("one parent for every node", "po jedan roditelj za svaki čvor"),
    (
        "give each place a node of its own that names the same mesh",
        "daj svakom mjestu vlastiti čvor koji imenuje istu mrežu",
    ),
    (
        "{} edges run past one another so closely that more than {} pairs would have to be compared",
        "bridova koji prolaze tijesno jedan uz drugoga: {}; trebalo bi usporediti više od {} parova",
    ),
    ("edges of which at most {} pairs lie side by side", "bridovi od kojih najviše {} parova leži jedan uz drugoga"),
    (
        "the file rounds coordinates by up to {} m, {} % of the distance of neighbouring nodes: they lie up to {} m from the origin in numbers of {} bytes",
        "datoteka zaokružuje koordinate za najviše {} m, {} % razmaka susjednih čvorova: leže do {} m od ishodišta u brojevima od {} bajta",
    ),
    ("up to {} %; above {} % is an error", "do {} %; iznad {} % je pogreška"),
    (
        "move the shape to the origin before it is saved, or save it in a format with numbers of 8 bytes",
        "pomakni oblik u ishodište prije spremanja ili ga spremi u zapisu s brojevima od 8 bajtova",
    ),
    ("move the shape to the origin before it is saved", "pomakni oblik u ishodište prije spremanja"),
    ("{} more things are left out", "izostavljeno još: {}"),
    ("{} more thing is left out", "izostavljeno još: {}"),
];
