# What the reader of scenes says.

## AllowedValues

part-allowed-Finite = konačan broj
part-allowed-Bound = broj { $bound }
part-allowed-Between = broj { $low } i { $high }
part-allowed-Integer = cijeli broj od { $least } do { $greatest }
part-allowed-Boolean = true ili false
part-allowed-Text = tekst od najviše 256 bajtova
part-allowed-Choice = jedno od { $words }
part-allowed-Vector = konačni brojevi, njih { $dimension }
part-allowed-Direction = konačni brojevi koji nisu svi nula, njih { $dimension }
part-allowed-Numbers = popis konačnih brojeva
part-allowed-Integers = popis cijelih brojeva od 0
part-allowed-Points = popis točaka od po { $dimension } konačnih brojeva
part-allowed-Curve = krivulja [[t, vrijednost], …] konačnih brojeva, t raste
part-allowed-CurveNotNegative = krivulja [[t, vrijednost], …] konačnih brojeva, t raste, vrijednosti >= 0
part-allowed-Path = put [[t, { $axes }], …] konačnih brojeva, t raste

## Alternatives

part-alternatives-Last = { $word }
part-alternatives-Either = { $word } ili { $rest }

## ConditionText

part-condition-Dimension = u { $dimension }D
part-condition-Word = gdje je `{ $field }` { $words }
part-condition-Given = uz `{ $field }`
part-condition-GivenOneOf = uz { $fields }
part-condition-NotGiven = bez `{ $field }`
part-condition-NotZero = gdje `{ $field }` nije 0
part-condition-Lattice = za tijelo koje ispunjava rešetka
part-condition-Section = u sceni s odjeljkom `[{ $section }]`

## ValueError

scene-unknown_field-UnknownField = nema polja `{ $name }`
    .hint = { $nearest ->
        [none] {""}
       *[other] misliš li `{ $nearest }`?
    }
scene-range-NotAllowed = `{ $name }` je { $value }
    .allowed = { $allowed }

## ChoiceError

model-one_of-OneOf = treba zadati točno jedno od { $fields }
model-one_of-None = treba zadati točno jedno od { $fields }; ovdje nema nijednoga
model-one_of-Several = treba zadati točno jedno od { $fields }; ovdje su { $given }

## ValueKind

part-value_kind-Table = tablica
part-value_kind-List = popis
part-value_kind-Text = tekst
part-value_kind-Whole = cijeli broj
part-value_kind-Number = broj
part-value_kind-Truth = istina ili laž
part-value_kind-Date = datum

## Wanted

part-wanted-Table = tablica
part-wanted-Tables = popis tablica
part-wanted-Text = tekst
part-wanted-Selector = tablica, kao {"{"} all = true {"}"}
part-wanted-Selectors = popis izbora
part-wanted-Node = broj čvora, "nearest" ili "nearest_facet"
part-wanted-Counts = popis cijelih brojeva, kao [10, 5]
part-wanted-Recorded = popis iz position, velocity, reaction, contact, stress, volume_ratio
part-wanted-Body = ime tijela ili njegov broj

## Part

part-scene_part-Shape = oblika
part-scene_part-Model = modela
part-scene_part-Integrator = integratora
part-scene_part-Collider = prepreke
part-scene_part-Load = opterećenja
part-scene_part-Command = naredbe

## SceneAllowed

part-scene_allowed-Wholes = cijeli brojevi između -9007199254740992 i 9007199254740992 (2^53)
part-scene_allowed-Angle = kut u radijanima, suprotno od kazaljke na satu
part-scene_allowed-Spin = brzina vrtnje u rad/s, suprotno od kazaljke na satu
part-scene_allowed-AngleInSpace = os puta kut oko nje u radijanima: tri broja
part-scene_allowed-SpinInSpace = os puta brzina vrtnje oko nje u rad/s: tri broja
part-scene_allowed-Counts = 1 do { $dimension } cijelih brojeva od 1
part-scene_allowed-OneOf = točno jedno od { $fields }
part-scene_allowed-NothingToChange = ništa, nema se što mijenjati
part-scene_allowed-NoBodies = prizor nema tijela
part-scene_allowed-Bodies = tijela: { $count }, po imenu ili po broju od 0 do { $last }
part-scene_allowed-ThereAreNone = nema ih
part-scene_allowed-RingsApart = prstenovi razdvojeni ili jedan u drugom
part-scene_allowed-HolesInRings = u prstenu rupe, negativnog polumjera, a u rupi prstenovi
part-scene_allowed-HolesInside = rupe u prstenu pozitivnog polumjera

## SceneHint

part-scene_hint-Purpose = { ABOUT($field) }
part-scene_hint-NoQuotes = napiši to bez navodnika
part-scene_hint-DecimalPoint = veći broj napiši s decimalnom točkom
part-scene_hint-Misspelt = `{ $word }` je krivo napisano
part-scene_hint-BeginFormat = započni datoteku s format = "{ $format }"
part-scene_hint-Section = napiši [{ $name }]
part-scene_hint-Sections = napiši [[{ $name }]]
part-scene_hint-Inline = napiši { $name } = [ {"{"} … {"}"} ]
part-scene_hint-PassThrough = uz `contact = {"{"} touch = false {"}"}` tijelo prolazi kroz sva druga, uz `contact = {"{"} self = false {"}"}` kroz sebe; uz `[[contact.pair]]` s `touch = false` dvije skupine prolaze jedna kroz drugu
part-scene_hint-KeepApart = odjeljak `[contact]` drži sva tijela razdvojenima; vrijednosti u `contact = {"{"} … {"}"}` tijela zamjenjuju njegove
part-scene_hint-NoSection = bez odjeljka `[contact]` tijela prolaze jedno kroz drugo
part-scene_hint-KindSet = `{ $table }.kind` je postavljen na `{ $kind }`, a druga su polja ostala; --set { $table }={ $kind } uzima njegove zadane vrijednosti
part-scene_hint-KindSetWith = `{ $table }.kind` je postavljen na `{ $kind }`, a druga su polja ostala; --set '{ $table }={"{"}kind="{ $kind }"{ $needed }{"}"}' ih zamjenjuje
part-scene_hint-Copies = `{ $name }` ima kopija: { $count }: `{ $name }[0]` … `{ $name }[{ $last }]`
part-scene_hint-QuarterTurn = 1.5708 je četvrtina okreta (90°)
part-scene_hint-TurnsInSpace = [0, 0, 1.5708] zakreće za 90° oko z, [0.5236, 0, 0] za 30° oko x; 1° je 0.0174533
part-scene_hint-SpinsInSpace = [0, 0, 6.2832] okreće se jednom u sekundi oko z
part-scene_hint-Extent = na početku tijelo leži između { $low } i { $high }
part-scene_hint-OwnName = svako tijelo treba svoje ime; mnogo jednakih su `copies`
part-scene_hint-Change = naredba `do = "change"` daje tijelu druge modele ili drugi integrator
part-scene_hint-Simplices = `simplices = true` reže ih na trokute ili tetraedre
part-scene_hint-Centers = prstenovi se broje od 0; pomiče ih `centers`
part-scene_hint-TwoChambers = prstenovi se broje od 0; dvije komore plina razdvaja rupa među njima ili zasebno tijelo
part-scene_hint-Gradient = [[0.1, 0], [0, 0]] rasteže duž x, [[0, 1], [0, 0]] smiče
part-scene_hint-GradientInSpace = [[0.1, 0, 0], [0, 0, 0], [0, 0, 0]] rasteže duž x
part-scene_hint-ListScenes = `opruga list` pokazuje prizore iz programa
part-scene_hint-Frames = naredbe počinju i završavaju sa sličicom, prvom u njihovo vrijeme ili kasnije; ovdje jedna počinje svakih { $frame } s

## FieldError

scene-range-Is = `{ $field }` je { $value }
scene-type-Type = `{ $field }` je { $kind }
scene-unknown_word-Word = `{ $field }` je { $value }
scene-not_finite-NotFiniteField = `{ $field }` nije konačan
scene-not_finite-TooLarge = `{ $field }` je prevelik za 64-bitni broj
scene-length-Length = `{ $field }` ima { $count ->
        [1] jedan broj
       *[other] brojeva: { $count }
    }
scene-range-NotRising = t ne raste: { $time } slijedi nakon { $before }
scene-type-Lists = `{ $field }` je popis popisa
    .hint = napiši brojeve svih jedan za drugim, u jednom popisu
scene-range-Angle = `rotation` je { $value }: gdje u svom okretu tako velik kut završava, gubi se u zaokruživanju
    .allowed = kutovi do 1e6 radijana
    .hint = puni okreti od 6.283185307179586 radijana ništa ne mijenjaju
scene-missing-Missing = { $fields } { $count ->
        [1] nedostaje
       *[other] nedostaju
    } u `{ $table }`
scene-missing-MissingInScene = { $fields } { $count ->
        [1] nedostaje
       *[other] nedostaju
    } u prizoru
scene-missing-NoTag = u opisu { $table } nedostaje `{ $tag }`
scene-dimension-KindDimension = `{ $kind }` ne postoji u { $dimension }D
    .allowed = dimenzija { $dimensions }
scene-unknown_kind-NoKind = nema { $table } `{ $word }`
scene-unknown_field-NoField = nema polja `{ $field }` u `{ $table }`
scene-unknown_field-NoFieldInScene = nema polja `{ $field }`
scene-no_effect-NoEffect = `{ $field }` ovdje ne djeluje; djeluje samo { $condition }
scene-format-Format = zapis je { $value }
    .allowed = { $readable }
    .hint = ova inačica čita samo opruga-1; druga inačica programa možda čita ovaj prizor
scene-format-NoFormat = nedostaje zapis (`format`)
    .allowed = { $readable }
scene-dimension-WrongDimension = `dimension` je { $value }
    .allowed = 2 ili 3
scene-missing-NoDimension = `dimension` nedostaje
    .allowed = 2 ili 3
scene-more-More = i još { $count }

## BodyError

scene-not_here-NoCopies = tijelo koje naredba dodaje nema kopija
    .hint = napiši po jednu naredbu za svako tijelo
scene-no_values-NoCellNumbers = ćelije mreže nemaju brojeve `{ $name }`
scene-range-Density = gustoća ćelije { $cell } je { $density } kg/m³
    .allowed = broj > 0
scene-missing-NoMass = tijelo nema masu
    .allowed = točno jedno od mass, density, density_of_cells, node_mass
    .hint = tijelo koje se nikad ne miče je `fixed = true`
scene-conflict-SeveralMasses = tijelo ima `{ $first }` i `{ $second }`
    .allowed = točno jedno od mass, density, density_of_cells, node_mass
scene-shape-NoCells = `{ $field }` govori o ćelijama, a oblik ih nema
    .hint = ispunjeni su oblici `grid`, datoteke s `filling` i `mesh`
scene-range-Tiny = `scale` je { $value }: umnošci tako malih duljina jednaki su nuli
    .allowed = od 1e-70
    .hint = koordinate su u metrima: `scale = 1e-6` čini od njih mikrometre
scene-range-Vast = `{ $field }` je { $value }: umnošci takvih duljina više nisu brojevi
    .allowed = koordinate do 1e70 m od ishodišta oblika
scene-range-MadeVast = `{ $field }` ga čini prevelikim: umnošci takvih duljina više nisu brojevi
    .allowed = koordinate do 1e70 m od ishodišta oblika
scene-missing-WireWidth = `density` žice treba njezinu širinu, ovdje `thickness`
    .allowed = broj > 0
    .hint = ili zadaj `mass` cijelog tijela
scene-missing-WallThickness = tijelo je šuplje, a `density` šupljeg tijela treba debljinu stijenke, `thickness`
    .allowed = broj > 0
    .hint = ili zadaj `mass` cijelog tijela, ili ga ispuni: poljem `filling` oblika ili oblikom `grid`
scene-missing-SheetThickness = `density` opne treba njezin `thickness`
    .allowed = broj > 0
    .hint = ili zadaj `mass` cijelog tijela
scene-shape-NotFiniteShape = koordinata oblika je { $value }
    .allowed = konačne koordinate
shape-flipped-Clockwise = točke tijela `{ $body }` idu u smjeru kazaljke na satu
    .hint = njegovi bridovi idu njima suprotno
scene-conflict-TwoSpins = tijelo ima i `angular_velocity` i `velocity.angular`
    .allowed = jedno od toga
scene-length-Gradient = `gradient` ima { $count ->
        [1] { $count } redak
       *[other] { $count } redaka
    }
    .allowed = redaka: { $dimension }, u svakom isto toliko konačnih brojeva: kako se svaka os brzine mijenja duž svake osi
scene-no_values-NoNodeVectors = čvorovi mreže nemaju vektore `{ $name }`
    .hint = vektori čvorova su `$NodeData` u datotekama Gmsha, `POINT_DATA` u VTK i `<PointData>` u VTU
scene-no_values-NotAMeshFile = `{ $name }` stajalo bi u datoteci mreže, a oblik je `{ $kind }`
    .hint = `kind = "mesh"` čita takvu datoteku
scene-length-ComponentsInPlane = `{ $name }` ima brojeva po čvoru: { $components }
    .allowed = 2, ili 3 od kojih je zadnji 0
    .hint = brzina je vektor
scene-length-ComponentsInSpace = `{ $name }` ima brojeva po čvoru: { $components }
    .allowed = 3
    .hint = brzina je vektor
scene-not_finite-NodeValue = `{ $name }` čvora { $node } iznosi { $value }
    .allowed = konačni brojevi za svaki čvor
    .hint = čvorovi se broje od 0
scene-dimension-LeavesPlane = `{ $name }` čvora { $node } izlazi iz ravnine
    .allowed = 0 duž osi z
    .hint = čvorovi se broje od 0; `dimension = 3` na početku scene u prostoru
scene-range-Rotation = { $problem }
scene-range-Turned = `{ $name }`, zakrenuto s tijelom, iznosi { $value }
    .allowed = konačni brojevi
scene-conflict-PinnedTwice = čvor { $node } tijela `{ $body }` drži i `{ $pin }`{ $line ->
        [none] {""}
       *[other] {" "}u retku { $line }
    }, koji ga vodi drugamo duž osi { $axis } u t = { $time } s
    .allowed = jedno gibanje za svaki čvor duž svake osi
    .hint = neka izbori nemaju zajedničkih čvorova, ili neka pribadače drže različite osi (`axes`)
scene-range-Axes = `axes` je "{ $letters }"
    .allowed = jedno od "x", "y", "xy"
    .hint = u 2D nema z

## CommandError

scene-missing-NoEnd = nedostaje `until`: put od jedne točke ne kaže kad vuča prestaje
    .allowed = vrijeme nakon { $at }
    .hint = put od više točaka završava vuču svojom zadnjom točkom
scene-range-EndsBefore = naredba završava u { $until } s, prije nego što počinje u { $at } s
    .allowed = vrijeme od { $at }
scene-range-LastsNegative = naredba završava u { $until } s, prije nego što počinje u { $at } s
    .allowed = vrijeme nakon { $at }
scene-range-EndsAtOnce = naredba završava u { $until } s, kad i počinje u { $at } s
    .allowed = vrijeme nakon { $at }
scene-missing-ChangesNothing = naredba ništa ne mijenja
    .allowed = `models`, `integrator` ili oboje
scene-range-BeforeAdded = naredba počinje u { $at } s, prije nego što se `{ $body }` dodaje u { $added } s
    .allowed = vrijeme od { $added }
scene-range-AfterRemoved = naredba počinje u { $at } s, nakon što se `{ $body }` uklanja u { $removed } s
    .allowed = vrijeme prije { $removed }
command-never-AfterEnd = naredba počinje u { $at } s, nakon kraja u { $end } s
    .hint = događa se samo u izvođenju s većim --seconds
command-never-NoFrame = naredba počinje u { $at } s, a tada ni kasnije ne počinje nijedna sličica izvođenja
    .hint = naredbe počinju sa sličicom; ova se događa samo u izvođenju s većim --seconds
command-never-BetweenFrames = naredba počinje u { $at } s i završava u { $until } s, prije početka ijedne sličice
command-never-SetAgain = `{ $parameter }` se postavlja u { $first } s i opet u { $second } s, prije početka ijedne sličice
scene-range-CannotBe = `{ $parameter }` ne može biti { $value }
scene-unknown_parameter-NotInRun = nema parametra koji se mijenja tijekom izvođenja `{ $parameter }`
scene-unknown_parameter-NoCollider = nema prepreke `{ $collider }`
scene-unknown_parameter-NoModel = ovo tijelo nema model `{ $model }`
scene-unknown_parameter-NoBodyOfPath = nema tijela `{ $body }`
scene-unknown_parameter-NoParameter = nema parametra `{ $parameter }` u `{ $kind }`
scene-unknown_parameter-NoIntegrator = tijelo `{ $body }` nema svoj integrator
    .allowed = integrator.FIELD
scene-unknown_parameter-NotAParameter = `{ $parameter }` nije parametar

## ReferenceError

scene-unknown_name-NoBodyCalled = nema tijela `{ $body }`
scene-unknown_name-NoBodyAt = nema tijela { $index }
scene-selects_nothing-NoFacet = čvorovi tijela `{ $body }` koje opterećenje bira ne drže nijednu cijelu stranicu njegove granice
    .allowed = barem svi čvorovi jedne stranice: brida obrisa ili trokuta plohe
    .hint = `side`, `group` i `boundary` biraju cijele strane; `kind = "force"` djeluje na čvorove
scene-selects_nothing-NoBoundary = čvorovi tijela `{ $body }` koje opterećenje bira ne drže nijednu cijelu stranicu njegove granice
    .allowed = tijela koja imaju granicu
    .hint = lanac je nema; `kind = "force"` djeluje na čvorove
scene-selects_nothing-NoCellsToLoad = opterećenje djeluje na obujam ćelija, a `{ $body }` nema ćelija
    .allowed = tijela koja su ispunjena: `grid`, oblici s `filling`, mreže tijela
    .hint = `kind = "force"` djeluje na čvorove; `world.gravity` na sve što ima masu
scene-selects_nothing-NoCell = čvorovi tijela `{ $body }` koje opterećenje bira ne drže nijednu cijelu ćeliju
    .allowed = barem svi čvorovi jedne ćelije
    .hint = bez `select` opterećenje djeluje na sve ćelije; `group` bira one iz datoteke mreže
scene-length-RecordsNothing = `record` je prazan
scene-duplicate_name-RecordedTwice = `{ $word }` se bilježi dvaput
scene-unknown_word-Records = `record` sadrži { $value }
scene-no_stress-NoStress = `{ $word }` se bilježi za `{ $body }`, a nijedan model tog tijela ne zna za naprezanje
    .allowed = tijela s modelom { $kinds }
    .hint = `reaction` i `contact` su sile, koje ima svako tijelo
scene-selector-Keys = izbor ima točno jedan ključ, ovdje: { $count }
    .hint = skupove spoji s {"{"} and = [ … ] {"}"} ili {"{"} or = [ … ] {"}"}
scene-selector-NotTrue = `{ $field }` je { $value }
    .allowed = true
scene-length-Corners = `box` ima uglova: { $count }
    .allowed = dva nasuprotna ugla
scene-range-NoNormal = `normal` je nula
    .allowed = vektor koji nije nula
scene-length-NoSelectors = `{ $field }` je prazan
    .allowed = popis od barem jednog izbora
scene-unknown_field-NoSelector = nema izbora `{ $word }`
scene-missing-OneCorner = `{ $one }` je jedan ugao kvadra, a drugi, `{ $other }`, nedostaje
    .hint = oba ugla ili nijedan: tada se prikazuje sve što se vidi
scene-range-EmptyBox = kvadar koji slike prikazuju nema unutrašnjosti
    .allowed = po svakoj osi više od `low` = { $low }
scene-dimension-Camera = `{ $field }` okreće kameru prizora u prostoru
    .allowed = u prizorima s `dimension = 3`

## NameFault

scene-name-Empty = ime je prazno
    .allowed = 1 do 256 bajtova bez upravljačkih znakova i . , [ ] = navodnika; ne samo znamenke
scene-name-Contains = ime sadrži `{ $letter }`
    .allowed = 1 do 256 bajtova bez upravljačkih znakova i . , [ ] = navodnika; ne samo znamenke
scene-name-Number = ime je broj, a to bi bilo mjesto tijela
    .allowed = 1 do 256 bajtova bez upravljačkih znakova i . , [ ] = navodnika; ne samo znamenke
scene-duplicate_name-TwoBodies = dva tijela zovu se `{ $name }`{ $line ->
        [none] {""}
       *[other] , prvo u retku { $line }
    }
scene-conflict-SamePair = par skupina `{ $first }` i `{ $second }` već je zadan{ $line ->
        [none] {""}
       *[other] , prvo u retku { $line }
    }
    .allowed = najviše jedan par istih dviju skupina, bilo kojim redom
    .hint = stavi sve vrijednosti tih skupina u jedan `[[contact.pair]]`
scene-duplicate_name-TwoProbes = dvije sonde zovu se `{ $name }`{ $line ->
        [none] {""}
       *[other] , prva u retku { $line }
    }
scene-duplicate_name-AlikeBodies = imena dvaju tijela izgledaju jednako i razlikuju se samo normalizacijom Unicodea, ovdje { $here ->
        [none] ništa
       *[other] { $here }
    }, ondje { $there ->
        [none] ništa
       *[other] { $there }
    }: `{ $name }`{ $line ->
        [none] {""}
       *[other] , prvo u retku { $line }
    }
scene-duplicate_name-AlikeProbes = imena dviju sonda izgledaju jednako i razlikuju se samo normalizacijom Unicodea, ovdje { $here ->
        [none] ništa
       *[other] { $here }
    }, ondje { $there ->
        [none] ništa
       *[other] { $there }
    }: `{ $name }`{ $line ->
        [none] {""}
       *[other] , prva u retku { $line }
    }

## BlueprintFault

scene-range-LostStep = korak od { $h } s gubi se u { $seconds } s: vrijeme bi stajalo
    .allowed = korak koji mijenja vrijeme
scene-range-ManyFrames = { $seconds } s ima sličica: { $frames }
    .allowed = najviše 1e12 sličica
scene-range-NoNode = tijelo `{ $body }` nema čvor { $node }
    .allowed = čvorovi od 0 do { $last }
scene-unknown_name-NoGroup = mreža tijela `{ $body }` nema skupinu `{ $group }`
    .allowed = { $known }
scene-unknown_name-NoGroups = mreža tijela `{ $body }` nema skupinu `{ $group }`
    .allowed = nema skupina
scene-selects_nothing-SelectsNothing = izbor ne pogađa nijedan čvor tijela `{ $body }`
scene-unknown_name-NoMember = nijedno tijelo nije u grupi `{ $group }`
    .allowed = { $known }
scene-unknown_name-NoBody = nema tijela { $index }
    .allowed = 0 do { $last }
scene-unknown_name-NoBodies = nema tijela { $index }
    .allowed = prizor nema tijela
scene-shape-NoNodes = nema čvorova
    .allowed = barem jedan čvor
scene-shape-FarNode = čvor { $node } leži u { $position }
    .allowed = koordinate do 1e70 m od ishodišta oblika
scene-length-Densities = ima brojeva: { $count }
    .allowed = po jedan za svaku ćeliju, njih { $cells }
scene-length-NodeVelocities = brzinu ima čvorova: { $count }
    .allowed = nijedan, ili svaki od čvorova, kojih je { $nodes }
scene-length-AngularVelocity = `angular_velocity` ima brojeva: { $count }
    .allowed = { $wanted }

## Measured

part-measured-Scene = prizor
part-measured-File = datoteka

## TextError

scene-syntax-NoValue = tekst nije TOML: nedostaje vrijednost
scene-syntax-OpenList = tekst nije TOML: popis otvoren u retku { $line } nije zatvoren
scene-syntax-OpenTable = tekst nije TOML: tablica otvorena u retku { $line } nije zatvorena
scene-syntax-Syntax = tekst nije TOML: „{ $reason }”
scene-duplicate_key-TwiceInLines = `{ $key }` je zadano dvaput, prvi put u retku { $line }
    .hint = zadrži jedno od toga
scene-duplicate_key-Twice = `{ $key }` je zadano dvaput
    .hint = zadrži jedno od toga
scene-encoding-Wide = prizor je napisan u UTF-16 ili UTF-32
    .allowed = UTF-8
    .hint = spremi ga kao UTF-8
scene-encoding-TwoMarks = prizor počinje dvjema oznakama redoslijeda bajtova (U+FEFF)
    .allowed = UTF-8, s najviše jednom oznakom redoslijeda bajtova
    .hint = spremi ga kao UTF-8 bez oznake redoslijeda bajtova
scene-encoding-Byte = bajt { $byte } nije UTF-8
    .allowed = UTF-8
    .hint = spremi ga kao UTF-8
scene-empty-Empty = prizor je prazan
    .hint = `opruga new IME` piše prizor za početak
scene-depth-Depth = tablice i popisi ugniježđeni su dublje od { $most }
    .allowed = najviše { $most } razina
scene-too_large-Pieces = tekst ima više vrijednosti, ključeva i redaka nego što stane u memoriju njegova čitača
    .allowed = najviše { $values } vrijednosti u popisima, ili { $lines } redaka s ključem
    .hint = veliki oblici idu u datoteke mreža
scene-too_large-Size = { $what } ima { $size } bajtova
    .allowed = najviše { $most } bajtova

## TextHint

part-text_hint-BracketBefore = između ovog mjesta i retka { $line } nedostaje `{ $bracket }`
part-text_hint-BracketHere = ispred ovog mjesta nedostaje `{ $bracket }`
part-text_hint-Unit = brojevi stoje bez jedinica: napiši { $bare }; jedinicu svakog polja kaže `opruga reference`
part-text_hint-Quotes = tekst s razmacima treba navodnike
part-text_hint-Sweep = `opruga sweep` uzima popise (8,16,32) i raspone (0.5..4:log:7), s izvođenjem za svaku vrijednost; vektor stoji u zagradama

## FileError

read-failed-Failed = datoteka se ne može pročitati: { $reason }
read-failed-NotHeld = nema datoteke `{ $name }`
    .allowed = { $known }
read-failed-NoFolder = nema datoteke `{ $name }`
    .allowed = prizor bez mape ne imenuje datoteke
read-failed-NotThere = datoteke `{ $name }` nema
    .hint = datoteke se traže u `{ $folder }`
read-not_regular_file-Folder = ovo je mapa
read-not_regular_file-NotRegular = ovo nije obična datoteka
read-changed-Changed = datoteka se mijenjala dok se čitala
    .hint = pokušaj opet kad bude spremljena
shape-outside-Outside = `{ $name }` vodi izvan mape prizora
    .allowed = datoteka u mapi prizora ili ispod nje, imenovana s /
    .hint = `--allow-outside` dopušta prizoru čitati datoteke odasvud

## OverrideError

set-syntax-NoOverride = `{ $argument }` nije zamjena
    .allowed = PATH=VALUE
    .hint = na primjer --set body.ball.mass=2
set-value-NoValue = nedostaje vrijednost
    .allowed = PATH=VALUE
set-value-Value = vrijednost nije TOML: „{ $reason }”
set-value-SeveralValues = vrijednost nije TOML: „{ $reason }”
    .allowed = jedna vrijednost
set-path-Path = `{ $path }` nije put
    .allowed = imena odvojena po jednom točkom
set-path-EmptyList = `{ $list }` nema zapis { $index }
    .allowed = prazno je
set-path-NoEntry = `{ $list }` nema zapis { $index }
    .allowed = brojevi od 0 do { $last }
set-path-NoEntryCalled = `{ $list }` nema zapis `{ $name }`
    .allowed = { $known }
set-path-SeveralEntries = `{ $list }` ima { $count } zapisa `{ $name }`
    .allowed = njihovi brojevi: { $indices }
set-path-NoFields = `{ $value }` je { $kind }, to nema polja
