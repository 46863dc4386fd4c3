# What is wrong with checkpoints, recordings and files that are written.

## CheckpointError

checkpoint-not_one-NotOne = ovo nije točka nastavka programa Opruga
    .allowed = cijela točka nastavka inačice 1
checkpoint-version-Version = točka nastavka ima inačicu { $found }; ovaj program čita inačicu 1
    .allowed = cijela točka nastavka inačice 1
checkpoint-cut_off-CutOff = točka nastavka je odrezana: ima { $found } od { $expected } bajtova
    .allowed = cijela točka nastavka inačice 1
checkpoint-too_long-TooLong = iza kraja točke nastavka stoji bajtova: { $extra }
    .allowed = cijela točka nastavka inačice 1
checkpoint-damaged-Damaged = točka nastavka oštećena je između bajtova { $from } i { $to }
    .allowed = cijela točka nastavka inačice 1

## RecordingError

recording-not_one-NotOne = ovo nije snimka programa Opruga
    .allowed = snimka inačice koju ovaj program čita
    .hint = opruga run PRIZOR --record DATOTEKA je zapisuje
recording-version-Version = snimka ima inačicu { $found }, koju ovaj program ne čita
    .allowed = snimka inačice koju ovaj program čita
    .hint = može je pročitati inačica programa koja ju je zapisala
recording-cut_off-CutOff = snimka je odrezana u zaglavlju: ima { $found } od { $expected } bajtova
    .allowed = snimka inačice koju ovaj program čita
recording-damaged-Damaged = snimka je oštećena između bajtova { $from } i { $to }
    .allowed = cijeli odsječci
recording-no_frame-NoFrame = snimka nema sličicu { $frame }
    .allowed = sličice od { $first } do { $last }
recording-no_frame-NoFrames = snimka nema sličicu { $frame }
    .allowed = nijedna: snimka nema sličica
recording-not_kept-NotKept = snimka čuva stanje svake { $every }. sličice, a stanje sličice { $frame } ne čuva
    .allowed = svaka { $every }. sličica, i zadnja
read-failed-Read = snimka se ne može pročitati: „{ $reason }”

## Doing

part-doing-Made = nastati
part-doing-Written = primiti datoteke
part-doing-Locked = biti zaključana
part-doing-Read = biti pročitana

## WriteFault

write-exists-FileExists = datoteka već postoji
    .hint = --force je zamjenjuje
write-exists-HoldsFile = mapa već sadrži { $file }
    .hint = --force zamjenjuje što je u njoj, --out bira drugu mapu
write-exists-HoldsFiles = mapa već sadrži datoteka: { $count }, među njima { $file }
    .hint = --force zamjenjuje što je u njoj, --out bira drugu mapu
write-failed-Stopped = pisanje je stalo nakon { $bytes } bajtova: „{ $reason }”
write-failed-IsFolder = ovo je mapa
write-failed-NoRegularFile = ovo nije obična datoteka
write-failed-NoFileName = putanja nema ime datoteke
write-failed-FileNotMade = datoteka ne može nastati: „{ $reason }”
write-failed-NoFolderAround = datoteka ne može nastati: „{ $reason }”
    .hint = nedostaje mapa oko nje
write-failed-FolderAroundNotMade = mapa oko nje ne može nastati: „{ $reason }”
write-failed-RecordingEnded = snimka je prije završila
write-locked-FileLocked = drugi proces piše ovu datoteku
    .hint = pričekaj ga ili odaberi drugo ime
write-locked-FolderLocked = drugi proces piše u ovu mapu
    .hint = pričekaj ga ili odaberi drugu mapu s --out
write-folder-Folder = mapa ne može { $doing }: „{ $reason }”
write-folder-IsFile = ovo je datoteka, a ne mapa
write-folder-Unwritable = { $problem }
    .hint = { HINT($problem) }
write-input-ReplacesInput = { $output } zamijenila bi { $input }, što je ulaz ovog poziva
    .hint = odaberi drugo ime; --force zamjenjuje samo izlaze, nikad ulaz
write-twice-OneFile = { $one } i { $other } ista su datoteka: ostala bi samo zadnja
    .hint = odaberi drugo ime za jednu od njih

## MeshWriteError

mesh-write-NoCellsToWrite = mreža nema ćelija
    .allowed = barem jedna ćelija
    .hint = ispuna pravi ćelije u plohi ili obrisu
mesh-write-Ending = datoteke s nastavkom `.{ $ending }` ne mogu se zapisati
    .allowed = .msh, .vtk, .vtu, .mesh, .mfem, .node, .ele
mesh-write-SecondOrder = ćelije drugog reda ne zapisuju se u datoteke { $format }
    .allowed = linearne ćelije
    .hint = primaju ih datoteke `.msh`, `.vtk` i `.vtu`
mesh-write-Boxes = TetGen nema četverokuta ni heksaedara
    .allowed = trokuti ili tetraedri

## EndingError

shape-format-Unreadable = datoteke s nastavkom `.{ $ending }` ne mogu se pročitati
    .allowed = datoteka mreže s poznatim nastavkom

## TapeFault

recording-input-Input = { $error }
    .hint = snimiti se mogu naredbe, `set`, `place_node` i `remove_body`

## TapeHint

part-tape_hint-RunEnded = ovdje je računanje završilo; --resume nastavlja od točke nastavka, s --record u drugu datoteku

## Tables of sweeps

write-exists-OtherQuestion = mapa sadrži niz s drugim pitanjem: { $difference }
    .hint = --force počinje iznova, --out uzima drugu mapu
write-failed-RowNotWritten = redak tablice ne može se zapisati: „{ $reason }”
    .hint = prijašnji redci su sačuvani; isti poziv nastavlja niz

## CallError

read-failed-NoSweep = nema niza: nedostaje { $file }
read-failed-FileUnreadable = datoteka se ne može pročitati: „{ $reason }”
read-failed-NoScene = nema takve datoteke, a ni takva prizora u programu
    .hint = prizori iz programa: { $scenes }
read-failed-NoSceneNear = nema takve datoteke, a ni takva prizora u programu
    .hint = misliš li { $closest }?
read-failed-NoSceneNearOf = nema takve datoteke, a ni takva prizora u programu
    .hint = misliš li { $closest } ili { $last }?
read-not_regular_file-NotARegularFile = ovo nije obična datoteka
scene-no_scene-ShapeFile = ovo je datoteka oblika, a ne prizor
    .hint = prizor je imenuje: shape = {"{"} kind = "{ $kind }", file = "{ $file }", … {"}"}; `opruga mesh` je pregledava
material-gradient-GradientNumber = `--F` ima `{ $word }`, što nije konačan broj
    .allowed = 4 konačna broja (2D) ili 9 (3D), redak po redak
    .hint = --F 1.1,0,0,1 rasteže ravninu za desetinu duž x; --F 1,0,0,0,1,0,0,0,1 je mirovanje u prostoru
material-gradient-GradientCount = `--F` ima brojeva: { $count }
    .allowed = 4 konačna broja (2D) ili 9 (3D), redak po redak
    .hint = --F 1.1,0,0,1 rasteže ravninu za desetinu duž x; --F 1,0,0,0,1,0,0,0,1 je mirovanje u prostoru
scene-unknown_name-NoMaterialToAsk = nema materijala `{ $name }`
    .allowed = { $known }
scene-dimension-PlaneInSpace = `--plane` je za ravninu, a F je prostoran
    .allowed = uz 4 broja u `--F`
scene-unknown_field-NoFieldOfLaw = `{ $law }` nema polja `{ $field }`
    .allowed = { $known }
scene-unknown_field-NoFields = `{ $law }` nema polja `{ $field }`
    .allowed = nijedno: E i ν su sve
checkpoint-version-OtherVersion = točka nastavka pripada drugoj inačici programa
