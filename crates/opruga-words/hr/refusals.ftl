# What models, integrators, obstacles and worlds refuse.

## BrokenOff

run-broken_off-Preparation = priprema je prekinuta

## Source

part-source-Of = { $kind }: { $about }
    .allowed = { ALLOWED($about) }
    .hint = { HINT($about) }

## StepError

part-step-Diverged = čvor { $node } tijela { $body } napustio je { $range ->
        [none] konačne brojeve
       *[other] područje u kojem je zaokruživanje sitno prema njegovim elementima, { $range } m oko ishodišta,
    } u t = { $time } s
part-step-NotConverged = `{ $integrator }` nije konvergirao ({ $iterations ->
        [1] jedna iteracija
       *[other] iteracija: { $iterations }
    }) u t = { $time } s{ $beyond ->
        [none] { $inverted ->
            [0] {""}
           *[other] , iz stanja u kojem su ćelije bez volumena ili izvrnute ({ $inverted } od { $cells })
        }
       *[other] , iza { $beyond } tereta
    }: sile su izvan ravnoteže za { $residual } N, a zadnji je popravak { $correction } m
    .allowed = { $tolerance } m
    .hint = { $hint }
part-step-BrokenOff = korak je prekinut
part-step-Model = { $model }: { $about }
    .allowed = { ALLOWED($about) }
    .hint = { HINT($about, $helps) }

## Unstable

step-not_finite-Forces = sile oko stanja nisu konačne, pa se ne može dati stabilni korak

## Springs

model-no_edges-NoEdges = tijelo nema bridova koji bi nosili opruge (`edges = "{ $edges }"`)
model-zero_length-NoLengthOfSpring = brid { $edge } nema duljinu, a `modulus` je treba
model-no_area-NoTriangles = `modulus` treba trokute uz bridove
    .hint = za lanac ili obris zadaj `stiffness`
model-mesh-Mesh = { $problem }

## Gas

model-open_surface-NoBoundary = tijelo nema zatvorenu granicu koja bi držala plin
model-open_surface-OpenBoundary = { $problem }
model-volume-NoVolume = komora { $chamber } obuhvaća { $volume } m³
    .allowed = > 0 (je li izvrnuta?)
model-not_manifold-Branches = { $problem }
model-no_cavity-NoCavity = granica nema rupa, pa nema ni šupljine koja bi držala plin
    .hint = `inside = "boundary"` puni tijelo

## Bending

model-one_of-NoThickness = `modulus` treba `thickness`
model-one_of-Thickness = `thickness` ide uz `modulus`, a ne uz `stiffness`
model-mesh-Bends = { $problem }
model-not_manifold-Hinges = { $problem }
model-no_hinges-NoHinges = tijelo nema što savijati: nijedan čvor između dvaju bridova obrisa ili lanca, nijedan brid između dvaju trokuta
model-zero_length-NoHingeLength = zglob { $hinge } ima u mirovanju brid bez duljine ili trokut bez površine

## The published program

model-dimension-Dimension = objavljeni program je ravninski
    .allowed = dimension = 2
model-open_surface-NoOutline = tijelo nema obrisa
model-one_of-NoPointer = `held` treba `pointer`
model-interval-Interval = svaki redak od `held` je [pritisak, puštanje], pritisak < puštanje
run-model-NoPublishedVolume = objavljeni „obujam” Σ ½ |Δx| |Δy| jednak je nuli: svaki brid leži duž osi
    .hint = malo zakreni tijelo

## Materials

scene-unknown_name-Unknown = nema materijala `{ $name }`
    .hint = { $nearest ->
        [none] {""}
       *[other] misliš li `{ $nearest }`?
    }
model-no_value-TooLarge = `{ $material }` nema vrijednosti uz taj gradijent deformacije, kojem je determinanta { $determinant }: brojevi su preveliki
    .allowed = det F > 0, i rastezanja koja zakon može slijediti
model-no_value-NoThicknessAcross = `{ $material }` nema vrijednosti uz taj gradijent deformacije, kojem je determinanta { $determinant }: nijedna pozitivna debljina nije bez naprezanja okomito na ravninu
    .allowed = det F > 0, i rastezanja koja zakon može slijediti
model-not_convex-NeverConvex = `poissons_ratio` je { $ratio }, s čime `mooney_rivlin` nije konveksan, koliki god bio `mooney_share`
    .allowed = najmanje { $least }, tako da je { $share } <= ν/(1 − 2ν)
    .hint = manji `mooney_share` dopušta manji, sve do 0
model-not_convex-NotConvex = `mooney_share` je { $share } uz `poissons_ratio` = { $ratio }, i nije konveksno
    .allowed = najviše { $most } = ν/(1 − 2ν)
    .hint = veći `poissons_ratio` dopušta veći

## Finite elements

part-simplices-Triangles = trokute
part-simplices-Tetrahedra = tetraedre
model-no_cells-NoCellsAtAll = tijelo nema ćelija: obris je, ploha ili lanac
    .allowed = ispunjeni oblici: `grid`, oblici iz datoteka s `filling` i mreže tijela
model-no_cells-EmptyGroup = skupina ćelija `{ $name }` je prazna
model-no_group-NoGroupOfCells = mreža nema skupinu ćelija `{ $name }`
    .allowed = { $known }
model-no_group-NoGroupsOfCells = mreža nema skupinu ćelija `{ $name }`
    .allowed = nema nijedne
model-temperature-NoGrowth = ćelija { $cell } bila bi dulja { $growth } puta uz `thermal_expansion` = { $expansion } 1/K od { $reference } K do { $now } K
    .allowed = više od 0
    .hint = čelik ima 1.2e-5 1/K, guma 2e-4 1/K
model-locking-LinearCellsLock = `poissons_ratio` je { $ratio } za linearne { $cells }, koji se blizu nestlačivosti ukoče
    .allowed = najviše { $most }
    .hint = `order = 2` tijelu, ili `locking = "nodal_volume"`
model-locking-NodalVolumeAndHeat = `locking` je "nodal_volume", a tijelo se rasteže toplinom, za koju obujmi čvorova ne znaju
    .allowed = "refuse" ili "accept"
    .hint = `order = 2` tijelu, ili četverokuti i heksaedri, također se ne ukoče
model-locking-NodalVolumeInPlaneStress = `locking` je "nodal_volume" u ravninskom naprezanju, gdje je debljina slobodna i ništa se ne ukoči
    .allowed = "refuse" ili "accept"
    .hint = izostavi `locking`
model-locking-NodalVolumeOfOthers = `locking` je "nodal_volume", ali ćelije nisu linearni trokuti ni tetraedri i ne ukoče se
    .allowed = "refuse" ili "accept"
    .hint = izostavi `locking`
model-no_values-NoValues = `{ $field }` je "{ $name }", a ćelije mreže nemaju takvih brojeva
    .allowed = { $known }
    .hint = `{ $instead }` daje jedan broj za sve ćelije
model-no_values-NoValuesAtAll = `{ $field }` je "{ $name }", a ćelije mreže nemaju takvih brojeva
    .allowed = nijedan, mreža nema brojeva ćelija
    .hint = `{ $instead }` daje jedan broj za sve ćelije
model-cell_value-CellValue = `{ $field }` ćelije { $cell } je { $value }
    .allowed = { $allowed }
    .hint = brojevi su u datoteci mreže; `{ $instead }` daje jedan za sve ćelije
model-inverted_cell-Inverted = ćelija { $cell } s čvorovima { $nodes } je izvrnuta u mirovanju: det ∂X/∂ξ = { $determinant }
    .allowed = više od { $least }
model-inverted_cell-FlatCell = ćelija { $cell } s čvorovima { $nodes } nema obujma u mirovanju: det ∂X/∂ξ = { $determinant }
    .allowed = više od { $least }
model-mass-Measure = { $problem }
run-no_thickness-NoThicknessLeft = ćelija { $cell } u t = { $time } s nema pozitivnu debljinu bez naprezanja okomito na ravninu: rastegnuta je ili izvrnuta više nego što njezin materijal u ravninskom naprezanju može slijediti

## MotionName

part-motion-Translation = pomak duž { $axis }
part-motion-Rotation = zakret
part-motion-RotationAbout = zakret oko osi duž { $axis }
part-motion-List = { $first }, { $rest }

## Integrators

integrator-real_time-DampsLittle = `accuracy` je "real_time", čiji koraci dio ostave izvan ravnoteže; `{ $integrator }` uz `spectral_radius` = { $radius } spora gibanja jedva prigušuje i predaje taj dio dalje s ubrzanjem koje pamti
    .allowed = "exact"
    .hint = `backward_euler` i `bdf2` mogu u stvarnom vremenu
integrator-real_time-DampsNothing = `accuracy` je "real_time", čiji koraci dio ostave izvan ravnoteže; `{ $integrator }` ništa ne prigušuje i zbrajao bi ga bez kraja
    .allowed = "exact"
    .hint = `backward_euler` i `bdf2` mogu u stvarnom vremenu
integrator-no_matrix-MatrixFreeInRealTime = `linear_solver` je "matrix_free", a `accuracy` je "real_time", koji čuva matricu
    .allowed = "auto", "conjugate_gradients", "cholesky"
integrator-no_matrix-MatrixFreeByArc = `linear_solver` je "matrix_free", a `arc_length` rastavlja matricu
    .allowed = "auto", "conjugate_gradients", "cholesky"
integrator-no_matrix-Unsymmetric = `linear_solver` je "matrix_free", čiji konjugirani gradijenti trebaju simetričnu matricu, a ona tijela nije simetrična
    .allowed = "auto"
static-rigid_modes-Free = ništa ne drži tijelo protiv: { $motions } ({ $count ->
        [1] jedan kruti pomak
       *[other] krutih pomaka: { $count }
    }); ravnoteža treba tijelo koje nešto drži
    .hint = pribodi toliko osi čvorova koliko je krutih pomaka, ili mu daj na čemu će ležati
static-rigid_modes-Endless = ništa ne drži tijelo protiv: { $motions } ({ $count ->
        [1] jedan kruti pomak
       *[other] krutih pomaka: { $count }
    }), jer su mu sile linearne: što ga zakreće, zakreće ga bez kraja, a težina ga ne vraća kao njihalo; ravnoteža treba tijelo koje nešto drži
    .hint = pribodi toliko osi čvorova koliko je krutih pomaka, ili uzmi materijal za velike zakrete, poput `neo_hookean`
static-rigid_modes-FreePiece = tijelo ima ovoliko komada: { $pieces }, a ništa ne drži onaj ({ $nodes ->
        [1] jedan čvor
       *[other] čvorova: { $nodes }
    }) oko { $center } protiv: { $motions } ({ $count ->
        [1] jedan kruti pomak
       *[other] krutih pomaka: { $count }
    }); ravnoteža treba da svaki komad nešto drži
    .hint = pribodi toliko osi njegovih čvorova koliko ima krutih pomaka, spoji ga s ostalima ili ga izostavi
static-arc_length_and_obstacles-LooseByArc = `arc_length` je zadan, a tijelo ne drže pribodene točke, i ništa ga ne pritišće na prepreke gdje krivulja počinje, bez ikakva tereta
    .allowed = pribodene točke koje ga drže, ili cijeli teret odjednom, u koliko god `load_steps` treba
run-model-Slides = tijelo leži na prepreci, a ni ona ni pribodene točke ne drže ga protiv: { $motions }; ravnoteža treba tijelo koje nešto drži
    .hint = za svaki pribodi os čvora, ili neka prepreka trlja (`friction`)
run-model-PieceSlides = tijelo ima ovoliko komada: { $pieces }, a onaj ({ $nodes ->
        [1] jedan čvor
       *[other] čvorova: { $nodes }
    }) oko { $center } leži na prepreci, a ni ona ni pribodene točke ne drže ga protiv: { $motions }; ravnoteža treba da svaki komad nešto drži
    .hint = za svaki pribodi os čvora, ili neka prepreka trlja (`friction`)
run-model-NoLoad = ništa ne opterećuje ono što je slobodno u t = { $time } s, a `arc_length` ide po dijelu tereta koji djeluje
    .allowed = težina ili tereti
    .hint = bez `arc_length` svaki korak završava gdje su pribodene točke i plinovi u ravnoteži
run-model-TurnsBack = krivulja ravnoteža kod { $load } tereta okreće se natrag ili oštro u stranu, koliko god korak bio kratak, do tisućinke `arc_length`; tu možda počinje grana drugog oblika
    .hint = mala sila ili oblik koji vodi na jednu granu, ili sav teret odjednom, bez `arc_length`

## StepHint

part-step_hint-Exact = više podkoraka, ili `accuracy = "exact"`; korak je već prepolovljen do 1/256
part-step_hint-Iterations = više podkoraka ili više `iterations`; korak je već prepolavljan do 1/256
part-step_hint-Halve = više podkoraka, više `iterations`, ili `when_not_converged = "halve"`
part-step_hint-Grown = koraci koji su vrijedili iako nisu konvergirali učinili su tijelo stotinu puta većim: više podkoraka, ili `when_not_converged = "halve"`
part-step_hint-ShorterArc = kraći `arc_length`, ili više `iterations`
part-step_hint-Arc = više `iterations`; teret je već prepolavljan do 1/256: gdje tijelo popusti, `arc_length` ga prati kroz preskok
part-step_hint-ThroughTime = više `iterations`; teret je već prepolavljan do 1/256: pravilo koje prigušeno korača kroz vrijeme nađe gdje će tijelo mirovati
part-step_hint-LoadStepsOrArc = `when_not_converged = "halve"`, više `load_steps`, ili više `iterations`; gdje tijelo popusti, `arc_length`
part-step_hint-LoadSteps = `when_not_converged = "halve"`, više `load_steps`, ili više `iterations`
part-step_hint-Rounding = položaji ovdje imaju šesnaest znamenki, koje ostavljaju otvorenim { $of_positions } m i sile od { $of_forces } N: veći `tolerance`, prizor bliže ishodištu, veće ćelije, ili manje kruto tijelo

## Obstacles

collider-kind-Kind = takve prepreke nema u { $dimension }D
collider-no_room-FilledBall = `thickness` je { $thickness }
    .allowed = manje od polumjera { $radius }
collider-no_room-FilledBox = `thickness` je { $thickness }
    .allowed = manje od polovice svake stranice, { $half }
collider-no_direction-NoNormal = `normal` je { $normal }
    .allowed = vektor duljine iznad { $least }
collider-no_direction-NoAxis = `a` je { $a }, a `b` je { $b }
    .allowed = dvije različite točke (jedna točka je `ball`)
collider-box_fields-BoxFields = treba ili `min` i `max`, ili `center` i `size`
collider-empty_box-EmptyCorners = `max` je { $max }, a `min` je { $min }
    .allowed = svaka koordinata od `max` iznad one od `min`
collider-empty_box-EmptySize = `size` je { $size }
    .allowed = duljine iznad 0
collider-points-FarPoints = `points` ima točaka: { $count }, od { $low } do { $high }
    .allowed = barem jedna, do 1e100 m jedna od druge
collider-points-FewPoints = `points` ima točaka: { $count }
    .allowed = barem { $least }
collider-points-NoExtent = točke nemaju protezanja
collider-flat_hull-NoArea = ljuska točaka `points`, kojih je { $count }, nema površine
    .allowed = točke koje nisu sve na jednom pravcu
collider-flat_hull-NoVolume = ljuska točaka `points`, kojih je { $count }, nema obujma
    .allowed = točke koje nisu sve u jednoj ravnini
collider-degenerate_facet-SamePoints = točke { $first } i { $second } obje su { $position }
    .allowed = dijelovi duljine iznad 0
collider-degenerate_facet-FlatTriangle = trokut { $triangle } s točkama { $points } nema površine
    .allowed = trokuti s površinom
collider-triangles-Triangles = `triangles` ima brojeva: { $count }
    .allowed = po tri za trokut, barem jedan trokut
collider-triangles-NoPoint = `triangles` imenuje točku { $point }
    .allowed = 0 do { $last }

## World

scene-unknown_name-NoModelHere = nema takvog modela
scene-unknown_name-NoIntegratorHere = nema takvog integratora
scene-unknown_name-NoKindHere = nema takve vrste ({ $what })
    .allowed = { $known }
scene-missing-NoFieldGiven = `{ $name }` nedostaje
stale_handle-StaleHandle = tijelo ove oznake nije više u ovom svijetu, ili nikad nije bilo
    .hint = `World::body` nalazi tijelo po imenu, `World::handle` daje njegovu oznaku
model-cells_twice-CellsTwice = ćelija { $cell } pripada modelima { $first } i { $second } tijela, čije bi se krutosti zbrojile
    .allowed = svaka ćelija u jednom modelu `{ $kind }`
    .hint = s `cells` imenuj skupine bez zajedničkih ćelija
model-uncovered_cells-Uncovered = { $count } od { $cells } ćelija, prva od njih { $first }, nije ni u jednoj skupini { $groups } modela: imale bi masu, a ne i krutost
    .allowed = svaka ćelija u jednom modelu
integrator-mass_matrix-MassMatrix = `mass` je "consistent", što povezuje ubrzanja čvorova ćelije, a `{ $integrator }` miče svaki čvor njegovom masom
    .allowed = "lumped"
    .hint = konzistentne mase idu uz backward_euler, bdf2, implicit_midpoint i newmark
model-mass-MassAndObstacles = `mass` je "consistent", a ima prepreka, čiji sudari djeluju na mase pojedinih čvorova
    .allowed = "lumped"
    .hint = konzistentne mase idu uz prepreke u `equilibrium`, gdje sudara nema
model-mass-NodeMass = `mass` je "consistent", a `node_mass` = { $mass } kg daje svakom čvoru istu masu, kakve god bile ćelije
    .allowed = "lumped"
    .hint = uz konzistentne mase ide `mass` ili `density` tijela
integrator-needs-NoSymmetry = model nema simetrične druge derivacije, koje treba `{ $integrator }`{ $why ->
        [none] {""}
       *[other] : { $why }
    }
    .hint = eksplicitni integrator ga korača, kao `symplectic_euler`, a `equilibrium` nalazi gdje miruje
integrator-needs-NoDerivatives = model nema druge derivacije, koje treba `{ $integrator }`{ $why ->
        [none] {""}
       *[other] : { $why }
    }
    .hint = eksplicitni integrator ga korača, kao `symplectic_euler`
integrator-needs-NoSymmetricModes = `{ $model }` nema simetrične druge derivacije{ $why ->
        [none] {""}
       *[other] : { $why }
    }
integrator-needs-NoModes = `{ $model }` nema druge derivacije
run-model-State = { $cause }
modes-all_held-AllHeld = svi čvorovi tijela pribodeni su po svim osima, i ništa na njemu ne može titrati
    .allowed = čvor slobodan po nekoj osi
    .hint = drugo tijelo ili manje pribodenih točaka
modes-no_mass-NoMassOfNode = čvor { $node } nema masu
    .allowed = mase iznad 0 gdje se čvor može micati
modes-memory-ModesMemory = { $count } oblika titranja tijela s ovoliko slobodnih koordinata: { $axes } traži oko { $bytes } bajtova
    .allowed = najviše { $most } bajtova
    .hint = manje oblika
modes-indefinite-Indefinite = krutost ovog stanja nema vlastitih frekvencija
contact-implicit-RestBesideMotion = `{ $integrator }` i integrator tijela `{ $other }` ne dodiruju se: jedan nalazi stanje mirovanja, a drugi se giba
    .allowed = tijela koja sva miruju ili se sva gibaju
    .hint = uz `contact.touch = false` tijelo prolazi kroz druga
contact-implicit-RestInParts = `{ $integrator }` uz `arc_length` ili `load_steps` stavlja teret u dijelovima, a tijela koja se dodiruju nalaze ravnotežu pod cijelim teretom
    .allowed = tijela koja se dodiruju bez `arc_length` i `load_steps`
    .hint = uz `contact.touch = false` tijelo prolazi kroz druga
run-model-NoAgreementAtRest = tijela koja se dodiruju ne nalaze zajedničku ravnotežu: koraci i dodir ne slažu se ni o jednom kraju, koliko god put bio kratak
    .hint = pribodene točke ili trenje drže ono što bi klizilo
run-model-NoCommonBalance = tijela koja se dodiruju ne nalaze zajedničku ravnotežu: nakon { $steps } koraka prema njoj još se gibaju za { $moved } m
    .hint = pribodene točke ili trenje drže ono što bi klizilo
contact-barrier-NoBarrier = `{ $integrator }` ne rješava za kraj koraka, što barijera treba
    .allowed = implicitni integrator, kao `backward_euler`
    .hint = ili `response = "constraint"`, koji prima svaki integrator
contact-reach-Reach = doseg je { $reach } m, a najkraći brid tijela { $shortest } m, pa bi se njegovi vlastiti dijelovi gurali u mirovanju
    .allowed = manje od tog brida
contact-thickness-Thickness = debljina je { $thickness } m, a najkraći brid tijela { $shortest } m, pa bi se njegovi vlastiti dijelovi gurali u mirovanju
    .allowed = manje od tog brida
    .hint = uz `contact = {"{"} self = false {"}"}` debljina tijela smije biti veća
contact-thickness-ThickerThanBody = debljina je { $thickness } m, a tijelo je veliko samo { $size } m
    .allowed = manje od veličine tijela
contact-unfold-Unfold = `unfold` pomiče tijela nasumce, i u druga
    .allowed = `unfold = false` u prizoru s `[contact]`
limit-memory-SceneMemory = tijela prizora traže oko { $all } bajtova, `{ $body }` od toga { $largest }
    .allowed = najviše { $most } bajtova
    .hint = grublja mreža, eksplicitni integrator ili `linear_solver = "matrix_free"`
limit-memory-MachineMemory = tijela prizora traže oko { $all } bajtova, `{ $body }` od toga { $largest }
    .allowed = što računalo daje ovom programu
    .hint = grublja mreža, eksplicitni integrator ili `linear_solver = "matrix_free"`
scene-range-FarBody = počinje { $farthest } m od ishodišta duž jedne osi, gdje zaokruživanje položaja smeta
    .allowed = najviše { $range } m, gdje je ono milijunti dio razmaka čvorova
    .hint = pomakni prizor u ishodište
scene-range-FastBody = zbog `velocity` i `angular_velocity` počinje s { $fastest } m/s duž jedne osi, u koraku od { $h } s
    .allowed = do { $range } m u koraku od { $h } s, s kojima korak završava tamo gdje položaji još imaju znamenke koje razlikuju čvorove
    .hint = jesu li mu jedinice pomiješane (metri, sekunde, radijani)?
scene-range-MassOfNode = `{ $word }` je { $value }, pa čvor { $node } ima masu { $mass } kg
    .allowed = takvo da masa svakog čvora ostaje među brojevima s punim znamenkama
    .hint = jesu li mu jedinice pomiješane (metri, kilogrami)?
scene-range-Weight = težina od { $weight } m/s² vodi energiju tijela izvan konačnih brojeva
    .allowed = najviše { $most } m/s² duž jedne osi
scene-range-BeyondFinite = `{ $word }` je { $value }, što energiju ili količinu gibanja tijela vodi izvan konačnih brojeva
    .allowed = brojevi čiji su kvadrati konačni, do { $most }
scene-range-Sums = njegova energija ili količina gibanja izvan je konačnih brojeva
    .hint = jesu li mu jedinice pomiješane (metri, kilogrami, sekunde)?
step-not_finite-NoEstimate = { $cause }
    .allowed = sile, krutosti i njihovi omjeri prema masama čvorova ispod 1e300
    .hint = najlakši čvor ima { $lightest } kg
step-not_finite-NoEstimateOf = { $cause }
    .allowed = sile, krutosti i njihovi omjeri prema masama čvorova ispod 1e300
    .hint = najveći broj njegovih modela je `{ $field }` = { $value } modela `{ $kind }`, a najlakši čvor ima { $lightest } kg
run-model-Pushed = prepreke guraju čvorove kroz druge, a barijera ih drži odvojene
    .hint = kraći koraci ili finije plohe
run-model-InvertedByBarrier = ćelija { $cell } izvrće se (omjer obujma { $ratio }), a barijera drži tijela odvojena
    .hint = materijal koji se tome opire, kao `neo_hookean`, ili kraći koraci
run-model-NoFactor = matrica koraka s barijerom nema faktor
    .hint = kraći koraci ili drugi materijal
run-model-NoCommonEnd = tijela koja barijera drži odvojena nemaju zajednički kraj koraka nakon { $iterations } iteracija
    .hint = kraći koraci ili više `iterations`

## Place

part-place-Body = tijelo `{ $name }`
part-place-BodyAt = tijelo { $index }
part-place-IntegratorOf = integrator tijela `{ $name }`
part-place-Load = opterećenje { $index }
part-place-Command = naredba { $index }
part-place-Probe = sonda `{ $name }`
part-place-Pair = contact.pair { $index }
part-place-Collider = prepreka { $index }
part-place-Section = { $path ->
        [world] svijet
       *[other] { $path }
    }

## WorldError

part-build-Build = { $part }: { $source }
    .allowed = { ALLOWED($source) }
    .hint = { HINT($source) }
step-unstable-UnstableStep = korak h = { $h } s integratora `{ $integrator }` nestabilan je za tijelo `{ $body }`
    .allowed = h <= { $limit } s (njegovo najbrže gibanje: { $omega } rad/s, prigušenje { $damping } 1/s)
    .hint = podkoraka >= { $substeps }, a sličica ima najviše 1000000 podkoraka; ili kraća sličica, mekše ili teže tijelo, ili drugi integrator
run-diverged-Diverged = tijelo `{ $body }` je divergiralo: čvor { $node } napustio je { $range ->
        [none] konačne brojeve
       *[other] područje u kojem je zaokruživanje sitno prema njegovim elementima, { $range } m oko ishodišta,
    } u podkoraku od t = { $time } s; svijet je na zadnjoj dobroj sličici, t = { $last } s
    .hint = { $range ->
        [none] više podkoraka može pomoći
       *[other] više podkoraka može pomoći; `world.largest_distance` uklanja što pada bez kraja
    }
run-model-Step = tijelo `{ $body }`: { $cause }; svijet je na zadnjoj dobroj sličici
    .allowed = { ALLOWED($cause) }
    .hint = { HINT($cause) }
run-not_converged-NotConverged = tijelo `{ $body }`: { $cause }; svijet je na zadnjoj dobroj sličici
    .allowed = { ALLOWED($cause) }
    .hint = { HINT($cause) }
run-overflow-Overflow = energija ili količina gibanja svih tijela zajedno prerasla je konačne brojeve u sličici od t = { $last } s; svijet je na zadnjoj dobroj sličici
    .hint = jesu li mase, krutosti i brzine u jedinicama koje idu zajedno (metri, kilogrami, sekunde)?
limit-contacts-TooManyContacts = u jednom koraku moglo bi se dodirnuti više od { $most } parova vrhova, bridova i ploha, u sličici od t = { $last } s; svijet je na zadnjoj dobroj sličici
    .allowed = { $most }
    .hint = veći `most_pairs` u `[contact]` ili grublje plohe
contact-surfaces_meet-Meet = plohe `{ $first }` i `{ $second }` bliže su od svoje debljine (`thickness`) u t = { $time } s, a barijera treba veći razmak; svijet je na zadnjoj dobroj sličici
    .hint = tijela koja počinju odvojena, manji `thickness`, ili `response = "constraint"`
contact-surfaces_meet-Cross = u t = { $time } s { $crossing } (parova tijela ukupno: { $pairs }), a barijera drži razmaknutima samo plohe koje se ne sijeku
    .hint = tijela koja počinju odvojena, ili `response = "constraint"`, koji ih razmiče
part-crossing-Within = strane { $first } i { $second } tijela `{ $body }` sijeku se
part-crossing-Between = strana { $first } tijela `{ $body }` i strana { $second } tijela `{ $other }` sijeku se
part-crossing-Inside = od tijela `{ $body }` i `{ $other }` jedno leži u drugome
contact-led_through-LedThrough = učvršćenja i prepreke vode `{ $first }` kroz `{ $second }` u t = { $time } s; svijet je na zadnjoj dobroj sličici
    .hint = drugi put učvršćenja tih tijela i prepreka uz njih, ili tijela koja prolaze jedno kroz drugo (`touch = false` u `[[contact.pair]]`)
contact-led_through-LedThroughObstacle = prepreka { $collider } ({ $kind }) i tijelo `{ $body }` prolaze jedno kroz drugo u t = { $time } s, jer ih tako vode prepreka, učvršćenja tijela ili druge prepreke; svijet je na zadnjoj dobroj sličici
    .hint = drugi put prepreke ili učvršćenja, ili više mjesta između te prepreke i drugih; uz `contact = {"{"} touch = false {"}"}` bridovi i vrhovi prepreka prolaze kroz tijelo, a prepreke dodiruju samo njegove čvorove
run-broken_off-BrokenOff = sličica je prekinuta; svijet je na zadnjoj dobroj sličici
path-unknown-Path = `{ $path }`: { $about }
    .allowed = { ALLOWED($about) }
    .hint = { HINT($about) }
snapshot-damaged-Snapshot = snimljeno stanje ne može se vratiti: { $about }

## PathFault

part-path-NoBody = nema takvog tijela
part-path-NoBodyCalled = nema tijela `{ $name }`
    .hint = { $nearest ->
        [none] {""}
       *[other] misliš li `{ $nearest }`?
    }
part-path-NoBodyThen = nema takvog tijela u t = { $time } s, kad naredba počinje
part-path-NoModel = tijelo `{ $body }` nema model `{ $kind }`
    .allowed = { $known }
part-path-FollowsScene = tijelo `{ $body }` slijedi integrator prizora: integrator.{ $field }
part-path-NoSuchIntegrator = nema takvog integratora
part-path-NoColliders = nema prepreke { $collider }
    .allowed = prizor ih nema
part-path-NoCollider = nema prepreke { $collider }
    .allowed = 0 do { $last }
part-path-NoColliderKind = nema takve vrste prepreke
part-path-NoContact = prizor nema `[contact]`, bez kojeg tijela prolaze jedno kroz drugo
    .allowed = u prizoru koji ga ima
part-path-Is = je { $value }
    .allowed = { $allowed }
part-path-IsText = je { $value }
    .allowed = { $allowed }
part-path-NoDirection = je { $value }
    .allowed = vektor duljine iznad 0
part-path-NotFinite = je { $value }
    .allowed = konačni brojevi
part-path-NoFieldOfWorld = nema `{ $field }` u `world`
    .allowed = { $known }
    .hint = { $nearest ->
        [none] {""}
       *[other] misliš li `{ $nearest }`?
    }
part-path-NotAParameter = to nije parametar
    .allowed = body.IME.models.VRSTA.POLJE, body.IME.integrator.POLJE, integrator.POLJE, collider.BROJ.POLJE, contact.POLJE, world.POLJE, time.substeps
part-path-NoNode = nema takvog čvora
    .allowed = 0 do { $last }
part-path-NoPosition = { $value } nije ni položaj ni brzina
    .allowed = konačni brojevi
part-path-Threads = dretve se ne mogu pokrenuti: „{ $reason }”
part-path-Taken = ime je zauzeto
part-path-NotNow = naredba počinje u { $at } s, a svijet je u { $now } s
part-path-NoCommand = nema takve naredbe
part-path-NoDrag = nije vuča, koja jedina ima put
part-path-Row = redak njezina puta je kasnije vrijeme i točka, sve konačno
part-path-CannotEnd = počinje u { $at } s i ne može završiti u { $until } s
part-path-ForceUnrecorded = sila koju poznaje samo program ne može se snimiti
part-path-ActUnrecorded = naredba koju program vodi dok djeluje ne može se snimiti
    .hint = umjesto toga spremi prizor s njom
part-path-BodyUnrecorded = tijelo koje dodaje program ne može se snimiti
part-path-ModelsUnrecorded = modeli koje tijelu daje program ne mogu se snimiti
part-path-Unrecorded = to se ne može snimiti
part-path-NoForm = nema oblika u prizoru
part-path-OtherDimension = prizor ima drugu dimenziju
part-path-AddsNothing = prizor sada ništa ne dodaje
part-path-NoCells = odabrani čvorovi ne drže nijednu cijelu ćeliju tijela
    .allowed = barem svi čvorovi jedne ćelije
part-path-NoFacets = izabrani čvorovi ne drže nijednu cijelu stranicu granice
    .allowed = barem svi čvorovi jedne stranice

## SnapshotFault

part-snapshot-Promises = najavljuje { $count } { $what }, više nego što ima
part-snapshot-EndsEarly = prerano završava
part-snapshot-Text = tekst nije UTF-8
part-snapshot-Value = vrijednost je nepoznate vrste
part-snapshot-Channel = kanal `{ $channel }` je nepoznate vrste
part-snapshot-ChannelNumber = kanal `{ $channel }` sadrži { $number }
part-snapshot-Unknown = sadrži { $what } vrste koja je ovdje nepoznata
part-snapshot-UnknownKind = sadrži `{ $kind }` vrste koja je ovdje nepoznata
part-snapshot-Gravity = nedostaje joj gravitacija
part-snapshot-Substeps = ima više podkoraka nego što ih sličica smije imati
part-snapshot-NoObstacle = mijenja prepreku koje nema
part-snapshot-NoBody = mijenja tijelo kojeg nema
part-snapshot-NotAdded = sadrži tijelo koje ovdje ne dodaje nijedna naredba
part-snapshot-NoMesh = tijelo ima mrežu onoga kojeg nema
part-snapshot-FromNowhere = tijelo nije došlo niotkud
part-snapshot-Field = u `{ $kind }`: { $problem }
part-snapshot-Input = što je program učinio, nepoznate je vrste
part-snapshot-Version = inačica joj nije { $version }
part-snapshot-Dimension = ima drugu dimenziju
part-snapshot-BodyCount = ima drugi broj tijela
part-snapshot-BodyPlace = tijelo je gdje ne može biti
part-snapshot-Generation = tijelo ima naraštaj onoga koje tek dolazi
part-snapshot-OtherShape = tijelo `{ $body }` ima drugi oblik
part-snapshot-NotFinite = tijelo `{ $body }` ima broj koji nije konačan
part-snapshot-CommandCount = ima drugi broj naredbi
part-snapshot-CommandHolds = naredba drži čega nema
part-snapshot-CommandState = naredba je u nepoznatom stanju
part-snapshot-Contact = njezini impulsi dodira nisu valjani
part-snapshot-GoesOn = nastavlja se iza svojeg kraja
part-snapshot-SceneGoesOn = što kaže o prizoru, nastavlja se iza svojeg kraja
part-snapshot-NoPair = nije stanje dvaju prizora jednog uz drugi

## Promised

part-promised-Bytes = bajtova
part-promised-Numbers = brojeva
part-promised-Letters = bajtova teksta

## Content

part-content-Body = tijelo
part-content-Mass = masu
part-content-Pin = pribadaču
part-content-Command = naredbu

## RefusalHint

part-refusal_hint-Substeps = podkoraka >= { $substeps }, kao --set time.substeps={ $substeps }; ili drugi integrator
part-refusal_hint-OtherValue = drugi `value`: sličica ima najviše { $most } podkoraka
part-refusal_hint-LargerValue = `value` od { $substeps } ili više, ili drugi integrator
part-refusal_hint-ValueOrEarlierCommand = drugi `value`, ili podkoraka >= { $substeps } kad naredba počinje, što postavlja naredba prije nje
part-refusal_hint-ValueOrSubsteps = drugi `value`, ili podkoraka >= { $substeps } kad naredba počinje, kao --set time.substeps={ $substeps }
part-refusal_hint-BodyOrEarlierCommand = mekše ili teže tijelo, ili podkoraka >= { $substeps } kad naredba počinje, što postavlja naredba prije nje
part-refusal_hint-BodyOrSubsteps = mekše ili teže tijelo, ili podkoraka >= { $substeps } kad naredba počinje, kao --set time.substeps={ $substeps }

## CommandRefusal

part-command-Command = naredba `{ $word }`: { $about }
    .allowed = { ALLOWED($about) }
    .hint = { HINT($about) }
