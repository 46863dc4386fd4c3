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
    .hint = zamijeni ih s --force ili odaberi drugu mapu
write-exists-HoldsFiles = mapa već sadrži datoteka: { $count }, među njima { $file }
    .hint = zamijeni ih s --force ili odaberi drugu mapu
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
    .hint = pričekaj ga ili odaberi drugu mapu
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
    .hint = snimiti se mogu naredbe, `set`, `set_node` i `remove_body`

## TapeHint

part-tape_hint-RunEnded = ovdje je računanje završilo; --resume nastavlja od točke nastavka, s --record u drugu datoteku

## Tables of sweeps

write-exists-OtherQuestion = mapa sadrži niz s drugim pitanjem: { $difference }
    .hint = --force počinje iznova, --out uzima drugu mapu
write-failed-RowNotWritten = redak tablice ne može se zapisati: „{ $reason }”
    .hint = prijašnji redci su sačuvani; isti poziv nastavlja niz

## NoSuchScene

read-failed-NoScene = nema takve datoteke, a ni takva prizora u programu
    .hint = prizori iz programa: { $scenes }
read-failed-NoSceneNear = nema takve datoteke, a ni takva prizora u programu
    .hint = misliš li { $closest }?
read-failed-NoSceneNearOf = nema takve datoteke, a ni takva prizora u programu
    .hint = misliš li { $closest } ili { $last }?

## CallError

read-failed-NoSweep = nema niza: nedostaje { $file }
read-failed-FileUnreadable = datoteka se ne može pročitati: „{ $reason }”
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

## CallRange

part-call_range-Between = od { NUMBER($least) } do { NUMBER($most) }
part-call_range-Positive = brojevi veći od 0
part-call_range-PositiveUpTo = brojevi veći od 0 do { NUMBER($most) }
part-call_range-FileName = ime datoteke
part-call_range-OneOf = { $names }

## CallFault

call-Arguments = { $text }
    .hint = --help kaže što se može zadati
call-OutOfRange = { $option } je { $value }; dopušteno: { $allowed }
call-NoInstructions = OPRUGA_SIMD={ $name }: dopušteni su scalar, sse2, avx2, avx512
call-NoIntegratorNear = nema integratora `{ $name }`
    .hint = misliš li `{ $closest }`?
call-NoIntegrator = nema integratora `{ $name }`
    .hint = integratori su { $known }
call-NoModel = nema modela `{ $name }`
call-NoObstacle = nema prepreke `{ $name }`
call-UnknownEnding = { $path } se ne može zapisati: nastavak `.{ $ending }` nije poznat
    .hint = poznati su { $known }
call-NotUtf8 = { $path } nije ime datoteke u UTF-8
call-NoSize = nedostaje --size
    .hint = --size H: otprilike duljina bridova [m]
call-NoScale = nedostaje --scale-to
    .hint = --scale-to L: dulja stranica crteža [m]
call-NoText = nedostaje --set text=…
    .hint = --set text=…, na primjer --set text=opruga, kaže što je napisano slovima fonta
call-HasCells = { $path } već ima ćelije
    .hint = bez --size i --scale-to datoteka se pokazuje i zapisuje u drugom formatu
call-NoShape = { $path }: datoteke s nastavkom `.{ $ending }` ne sadrže oblik
    .hint = datoteke koje se mogu pročitati završavaju na .obj, .stl, .ply, .gltf, .glb, .svg, .png, .json, .geojson, .topojson, .ttf, .otf, { $meshes }
call-SceneAsShape = { $path }: datoteke s nastavkom `.toml` ne sadrže oblik
    .hint = prizor čitaju `opruga check` i `opruga run`
call-NothingFills = u datoteci nema ničega što ispunjava tijelo
call-FilmRate = nijedan film ne može imati { $rate } slika u sekundi: --fps { $fps }, slike modela po { $frame } s
    .hint = moguće je od 0.0001 do 10000; --no-pictures radi bez filma
call-RunTooLong = --gltf, --pc2 i --mdd drže cijelo računanje u memoriji, a to je više od { $bytes } bajtova
    .hint = manji --fps, ili --from i --to
call-NoFrame = nema slike od { NUMBER($from) } s do { NUMBER($to) } s: snimka ih ima od { NUMBER($first) } s do { NUMBER($last) } s, svakih { NUMBER($apart) } s
call-NothingLeft = točka nastavka je u t = { NUMBER($time) } s, a računanje završava u { NUMBER($end) } s: ništa nije preostalo
    .hint = --seconds je simulirano vrijeme u kojem računanje završava: zadaj više od { NUMBER($time) }
call-NeverChanges = `{ $scene }` dolazi s programom i nikad se ne mijenja: --watch treba datoteku
    .hint = `opruga new IME` je zapisuje
call-NoScreen = ovdje nema zaslona na kojem bi se otvorio prozor
    .hint = `opruga run { $scene }` računa bez prozora i zapisuje slike
call-NoScreenForRecording = ovdje nema zaslona na kojem bi se otvorio prozor
    .hint = `opruga replay { $file }` zapisuje njezine slike
call-NoStudio = program `opruga-studio` ne leži pokraj ovoga
    .hint = cargo install --path crates/opruga-studio
call-StudioNotStarted = studio se ne može pokrenuti: „{ $reason }”
call-NoBody = u prizoru nema tijela
call-NoCaseNear = nijedan se slučaj ne zove `{ $word }`; porodice su { $families }
    .hint = misliš li `{ $closest }`? `opruga verify --list` pokazuje sve slučajeve
call-NoCase = nijedan se slučaj ne zove `{ $word }`; porodice su { $families }
    .hint = `opruga verify --list` pokazuje sve slučajeve

## Use

part-use-Input = ulaz
part-use-Scene = prizor { $path }
part-use-NamedByScene = `{ $name }`, koju imenuje prizor
part-use-NamedByInput = `{ $name }`, koju imenuje ulaz
part-use-Recording = snimka
part-use-Checkpoint = točka nastavka iz --resume
part-use-Option = { $option }
part-use-OfOutput = datoteka izlaza
part-use-OfFolder = datoteka iz mape izlaza

## QuestionDifference

part-question-Scene = tekst prizora bio je drugi
part-question-File = datoteka koju imenuje prizor bila je druga
part-question-Set = --set { $before } umjesto { $now }
part-question-Metric = --metric { $before } umjesto { $now }
part-question-Points = tražene su druge točke

## Pictures and plots

draw-failed-Size = slika od { $width } puta { $height } piksela ne može se nacrtati; svaka strana mora imati od 1 do 16384
draw-failed-Empty = nema se što nacrtati: { $nothing }
draw-failed-Node = tijelo { $body } ima { $nodes } čvorova, a { $list } imenuju čvor { $node }
draw-failed-Scalars = tijelo { $body } ima { $nodes } čvorova, a { $scalars } vrijednosti; može biti nijedna ili po jedna za svaki čvor
draw-failed-Dimension = slika ima dimenzija: { $dimensions }; mora ih imati 2 ili 3
draw-failed-FrameSize = sličica od { $found } piksela došla je u film od { $expected } piksela
draw-failed-Rate = film ne može imati { $rate } sličica u sekundi
draw-failed-Video = { $cause }
draw-failed-Png = zapis u PNG nije uspio: { $reason }
draw-failed-Gif = zapis u GIF nije uspio: { $reason }
part-nothing_to_draw-Picture = filmskoj vrpci treba slika
part-nothing_to_draw-FinitePlace = nijedno tijelo nema čvor na konačnom mjestu
part-nothing_to_draw-Cell = karti trebaju polje, stupac i redak
part-nothing_to_draw-Panel = dijagramu treba polje
part-nothing_to_draw-Sample = GIF-u trebaju uzorci sličica za paletu
part-nothing_to_draw-NumberOfCase = slučaj nema brojeva
part-nothing_to_draw-Parameter = nema parametra
part-nothing_to_draw-NumberOfSweep = nijedna točka niza nema broj za dijagram
part-picture_list-Areas = njegove površine
part-picture_list-LinesAtRest = njegove crte u mirovanju
part-picture_list-Facets = njegove strane
part-picture_list-Cells = njegove ćelije
part-picture_list-Segments = njegove dužine
part-picture_list-PinnedNodes = njegovi pričvršćeni čvorovi

## What a command meets

write-failed-Stdout = stdout se ne može pisati: { $reason }
interrupted-Interrupted = prekinuto; datoteke su zatvorene
contact-crossed-Crossed = u t = { $time } s { $crossing }
contact-crossed-CrossedByPairs = u t = { $time } s { $crossing }; parova tijela ukupno: { $pairs }

## CallWarning

threads-above_cores-AboveCores = dretvi: { $threads }, jezgara: { $cores }; više dretvi nije brže
simd-other-NeverScalar = OPRUGA_SIMD=scalar: računa se s { $used }, što ima svaki procesor ove vrste
simd-other-InstructionsLacking = OPRUGA_SIMD={ $asked }: ovaj procesor to nema; računa se s { $used }
diagnostics-thinned-Thinned = diagnostics.csv imao bi oko { $megabytes } MB, a bez zahtjeva zapisuje se { $most } MB: redak ima jedna od { $apart } sličica; --diagnostics-every 1 zapisuje sve
checkpoint-failed-CheckpointFailed = točka nastavka usput se nije mogla zapisati: { $cause }
checkpoint-failed-NoCheckpoint = nema točke nastavka u t = { $time } s: { $path }: { $cause }
recording-open-NoEnd = snimka nema kraja: računanje je prekinuto ili još traje; cijelih sličica do t = { $until } s: { $frames }, a bajtova iza njih, koji nisu cijela sličica: { $lost }
recording-program-OtherProgram = snimku je zapisao { $program }; ovo je { $now }
pictures-thinned-PicturesThinned = slike s toliko čvorova ({ $nodes }) zauzele bi { $mebibytes } MiB; čuva se jedna sličica od { $every }
scene-changed-SceneChanged = datoteka { $file } otad se promijenila; vrijedi prizor iz snimke

## CallNote

run-whole_frames-WholeFrames = sličice su cijele: računanje završava u t = { $reached } s, a ne u { $asked } s; sličica: { $frames }, svaka po { NUMBER($frame, maximumSignificantDigits: 4) } s
run-takes_long-TakesLong = računanje će trajati još oko { $duration } (sličica: { $frames }, svaka po { NUMBER($each, maximumSignificantDigits: 2) } s). Kraće: { $shorter }
pictures-rate-OtherRate = slika u sekundi: { NUMBER($rate, maximumSignificantDigits: 4) }, a ne { NUMBER($asked, maximumSignificantDigits: 4) } (--fps); od jedne do druge je cijeli broj sličica prizora, ovdje { $every } po { NUMBER($frame, maximumSignificantDigits: 4) } s
pictures-none-NoPlots = nema grafova: { $cause }
pictures-none-NoStrip = nema trake ni filma: { $cause }
pictures-none-NoVideo = nema filma jer je računanje prekinuto; `opruga run --resume` nastavlja od točke nastavka
threads-shared-SharedMachine = istodobnih računanja koja su dijelila stroj: { $threads }; za brzine uzmi --threads 1 (i --force)

## Shorter

part-shorter-RealTime = --set integrator.accuracy=real_time
part-shorter-Explicit = eksplicitno pravilo, --set integrator={ $integrator } --set time.substeps={ $substeps }
part-shorter-FewerSubsteps = manje podkoraka od { $substeps }: implicitna pravila nemaju najveći stabilni korak
part-shorter-Substeps = --set time.substeps={ $substeps }, što je stabilno za oblike u mirovanju
part-shorter-Threads = --threads { $threads }
part-shorter-Less = manje čvorova, ili raniji kraj (--seconds)
part-shorter-List = { $first }; { $rest }

## StartError

studio-call-NotUtf8 = `{ $argument }` nije tekst u UTF-8
studio-call-NoOption = nema opcije `{ $option }`
studio-call-SeveralScenes = navedeno je prizora: { $count }
    .allowed = najviše jedan
studio-no_window-NoWindow = prozor se ne može otvoriti: { $reason }
    .hint = `opruga run { $scene }` računa bez prozora i zapisuje slike
studio-no_window-NotStarted = prozor se ne može pokrenuti: { $reason }
studio-lost-ExitCode = prozor je izgubljen (izlazni kod { $code })
studio-lost-Signal = prozor je izgubljen (signal { $number })

## ResumeHint

part-resume_hint-FramesBefore = sličice prije toga su cijele: --to { $time } ih pokazuje
part-resume_hint-NoFrameBefore = prije toga nema cijele sličice
part-resume_hint-KilledAtStart = računanje je prekinuto prije nego što je zapisana prva sličica
part-resume_hint-CheckpointBefore = prijašnja točka nastavka je cijela, u t = { $time } s: --resume { $file }
part-resume_hint-InOutput = računanje je ostavlja u mapi svojeg izlaza, na primjer out/ball/checkpoint
part-resume_hint-NoneBeside = pokušaj sa starijom točkom nastavka; pokraj ove nema nijedne

## Recorded runs in the window

recording-led-Led = ovaj je tijek vodio program, što tekst prizora ne može reći
    .hint = `opruga replay` ga prikazuje
recording-scene-SceneNotUtf8 = prizor u snimci nije tekst u UTF-8
recording-override-NoValue = `{ $path }` je zadano kao `{ $value }`, što nije vrijednost
recording-override-NoPath = `{ $path }` u prizoru ne vodi ničemu
recording-no_frame-Empty = snimka nema sličica
recording-other_program-OtherProgram = prizor iz snimke ne vodi njezinu prvom stanju: snimio ju je drugi program
recording-damaged-DamagedBehind = iza sličice { $frame }: { $cause }
recording-damaged-State = { $cause }
