//! Sentences that models, integrators, obstacles and the world say, in English and in Croatian.

/// English and Croatian. `{}` stands for a name or a number that stays as it is, `{#}` for a value that has no words of
/// its own, `{~}` for a part of a sentence that is one of these sentences itself. The first that fits counts.
pub(super) const SENTENCES: &[(&str, &str)] = &[
    // Models.
    (
        "the selected nodes hold no whole cell of the body; allowed: all nodes of one cell at least",
        "odabrani čvorovi ne drže nijednu cijelu ćeliju tijela; dopušteno: barem svi čvorovi jedne ćelije",
    ),
    (
        "`{}` finds a state at rest, where bodies do not touch one another yet; allowed: an integrator of motion, such as \
         `backward_euler` or `verlet`; hint: or `contact.touch = false` in this body, which then passes through the others",
        "`{}` nalazi stanje mirovanja, u kojem se tijela zasad ne dodiruju; dopušteno: integrator gibanja, kao \
         `backward_euler` ili `verlet`; savjet: ili `contact.touch = false` u tom tijelu, koje tada prolazi kroz druga",
    ),
    (
        "`{}` does not solve for the end of a step, which a barrier needs; allowed: an implicit integrator, such as `backward_euler`; hint: or \
         `response = \"constraint\"`, which takes every integrator",
        "`{}` ne rješava za kraj koraka, što barijera treba; dopušteno: implicitni integrator, kao `backward_euler`; savjet: ili \
         `response = \"constraint\"`, koji prima svaki integrator",
    ),
    (
        "the reach is {} m and the shortest edge of the body {} m, so its own features would push one another at rest; allowed: less than that \
         edge",
        "doseg je {} m, a najkraći brid tijela {} m, pa bi se njegovi vlastiti dijelovi gurali u mirovanju; dopušteno: manje od tog brida",
    ),
    (
        "cell {} turns inside out (volume ratio {}), where a barrier keeps bodies apart; hint: a material that resists that, such as \
         `neo_hookean`, or smaller steps",
        "ćelija {} izvrće se (omjer obujma {}), a barijera drži tijela odvojena; savjet: materijal koji se tome opire, kao `neo_hookean`, ili \
         kraći koraci",
    ),
    (
        "bodies that a barrier keeps apart have no common end of the step after {} iterations; hint: smaller steps, or more `iterations`",
        "tijela koja barijera drži odvojena nemaju zajednički kraj koraka nakon {} iteracija; savjet: kraći koraci ili više `iterations`",
    ),
    (
        "obstacles push nodes through others that a barrier keeps apart; hint: smaller steps, or finer surfaces",
        "prepreke guraju čvorove kroz druge, a barijera ih drži odvojene; savjet: kraći koraci ili finije plohe",
    ),
    (
        "the matrix of a step with a barrier has no factor; hint: smaller steps, or another material",
        "matrica koraka s barijerom nema faktor; savjet: kraći koraci ili drugi materijal",
    ),
    (
        "`unfold` displaces bodies at random, into others too; allowed: `unfold = false` in a scene with `[contact]`",
        "`unfold` pomiče tijela nasumce, i u druga; dopušteno: `unfold = false` u prizoru s `[contact]`",
    ),
    ("the body has no {} edges to carry springs", "tijelo nema bridova ({}) koji bi nosili opruge"),
    ("edge {} has no length; `modulus` needs one", "brid {} nema duljinu, a `modulus` je treba"),
    ("exactly one of `{}` and `{}` must be given", "treba zadati točno jedno od `{}` i `{}`"),
    (
        "it begins {} m from the origin along an axis, where positions are rounded by {} m; allowed: at most {} m, where that is a \
         millionth of the distance of its nodes; hint: move the scene to the origin",
        "počinje {} m od ishodišta duž jedne osi, gdje se položaji zaokružuju za {} m; dopušteno: najviše {} m, gdje je to milijunti \
         dio razmaka čvorova; savjet: pomakni prizor u ishodište",
    ),
    (
        "`velocity` and `angular_velocity` let it begin with {} m/s along an axis, {} m in a step of {} s; allowed: at most {} m/s, \
         with which a step ends where positions still have digits that tell its nodes apart; hint: are its units mixed (metres, \
         seconds, radians)?",
        "zbog `velocity` i `angular_velocity` počinje s {} m/s duž jedne osi, {} m u koraku od {} s; dopušteno: najviše {} m/s, s \
         kojima korak završava tamo gdje položaji još imaju znamenke koje razlikuju čvorove; savjet: jesu li mu jedinice pomiješane \
         (metri, sekunde, radijani)?",
    ),
    (
        "`{}` is {}, with which node {} has a mass of {} kg; allowed: such that every node has at least {} kg and at most {} kg; hint: are \
         its units mixed (metres, kilograms)?",
        "`{}` je {}, pa čvor {} ima masu {} kg; dopušteno: takvo da svaki čvor ima najmanje {} kg i najviše {} kg; savjet: jesu li mu \
         jedinice pomiješane (metri, kilogrami)?",
    ),
    (
        "a weight of {} m/s² takes the energy of the bodies beyond the finite numbers; allowed: at most {} m/s² along an axis",
        "težina od {} m/s² vodi energiju tijela izvan konačnih brojeva; dopušteno: najviše {} m/s² duž jedne osi",
    ),
    (
        "`{}` is {}, which takes the energy or the momentum of the body beyond the finite numbers; allowed: numbers whose squares are \
         finite, up to {}",
        "`{}` je {}, što energiju ili količinu gibanja tijela vodi izvan konačnih brojeva; dopušteno: brojevi čiji su kvadrati \
         konačni, do {}",
    ),
    (
        "its energy or its momentum is beyond the finite numbers; hint: are its units mixed (metres, kilograms, seconds)?",
        "njegova energija ili količina gibanja izvan je konačnih brojeva; savjet: jesu li mu jedinice pomiješane (metri, kilogrami, \
         sekunde)?",
    ),
    (
        "`modulus` needs triangles next to the edges; give `stiffness` for a chain or outline",
        "`modulus` treba trokute uz bridove; za lanac ili obris zadaj `stiffness`",
    ),
    ("the body has no closed boundary to hold a gas", "tijelo nema zatvorenu granicu koja bi držala plin"),
    (
        "chamber {} encloses {} m³; allowed: > 0 (is it inside out?)",
        "komora {} obuhvaća {} m³; dopušteno: > 0 (je li izvrnuta?)",
    ),
    (
        "the boundary has no holes, so there is no cavity to hold a gas; `inside = \"boundary\"` fills the body",
        "granica nema rupa, pa nema ni šupljine koja bi držala plin; `inside = \"boundary\"` puni tijelo",
    ),
    (
        "the body has no cells: it is an outline, a surface or a chain. Filled shapes are `grid`, shapes from files with a \
         `filling`, and volume meshes",
        "tijelo nema ćelija: obris je, ploha ili lanac. Ispunjeni su oblici `grid`, oblici iz datoteka s `filling` i mreže tijela",
    ),
    ("the mesh has no group of cells `{}`; {}", "mreža nema skupinu ćelija `{}`; ima: {}"),
    ("the group of cells `{}` is empty", "skupina ćelija `{}` je prazna"),
    (
        "`{}` is \"{}\", and the cells of the mesh have no such numbers; allowed: {}; hint: `{}` gives one number for all cells",
        "`{}` je \"{}\", a ćelije mreže nemaju takvih brojeva; dopušteno: {}; savjet: `{}` daje jedan broj za sve ćelije",
    ),
    ("the cells of the mesh have no numbers `{}`", "ćelije mreže nemaju brojeve `{}`"),
    ("the density of cell {} is {} kg/m³", "gustoća ćelije {} je {} kg/m³"),
    (
        "`mooney_share` is {} with `poissons_ratio` = {}, and not convex; allowed: at most {} = ν/(1 − 2ν); hint: a larger \
         `poissons_ratio` allows a larger one",
        "`mooney_share` je {} uz `poissons_ratio` = {}, i nije konveksno; dopušteno: najviše {} = ν/(1 − 2ν); savjet: veći \
         `poissons_ratio` dopušta veći",
    ),
    (
        "`{}` of cell {} is {}; allowed: {~}; hint: the numbers are in the file of the mesh; `{}` gives one for all cells",
        "`{}` ćelije {} je {}; dopušteno: {~}; savjet: brojevi su u datoteci mreže; `{}` daje jedan za sve ćelije",
    ),
    (
        "cell {} would be {} times as long by `thermal_expansion` = {} 1/K from {} K to {} K; allowed: more than 0; hint: steel has \
         1.2e-5 1/K, rubber 2e-4 1/K",
        "ćelija {} bila bi dulja {} puta uz `thermal_expansion` = {} 1/K od {} K do {} K; dopušteno: više od 0; savjet: čelik ima \
         1.2e-5 1/K, guma 2e-4 1/K",
    ),
    (
        "`locking` is \"nodal_volume\", and the body expands by heat, which the volumes of nodes do not know; allowed: {}; hint: \
         `order = 2` for the body, or quadrilaterals and hexahedra, do not lock either",
        "`locking` je \"nodal_volume\", a tijelo se rasteže toplinom, za koju obujmi čvorova ne znaju; dopušteno: {}; savjet: \
         `order = 2` tijelu, ili četverokuti i heksaedri, također se ne ukoče",
    ),
    ("there is no material `{}`", "nema materijala `{}`"),
    (
        "`poissons_ratio` is {} for linear {}, which lock near incompressibility; allowed: at most {}; hint: `order = 2` for the \
         body, or `locking = \"nodal_volume\"`",
        "`poissons_ratio` je {} za linearne ćelije ({}), koje se blizu nestlačivosti ukoče; dopušteno: najviše {}; savjet: \
         `order = 2` tijelu, ili `locking = \"nodal_volume\"`",
    ),
    (
        "`locking` is \"nodal_volume\" in plane stress, where the thickness is free and nothing locks; allowed: {}; hint: leave \
         `locking` out",
        "`locking` je \"nodal_volume\" u ravninskom naprezanju, gdje je debljina slobodna i ništa se ne ukoči; dopušteno: {}; savjet: \
         izostavi `locking`",
    ),
    (
        "`locking` is \"nodal_volume\", but the cells are no linear triangles or tetrahedra, and do not lock; allowed: {}; hint: \
         leave `locking` out",
        "`locking` je \"nodal_volume\", ali ćelije nisu linearni trokuti ni tetraedri i ne ukoče se; dopušteno: {}; savjet: izostavi \
         `locking`",
    ),
    (
        "cell {} has no positive thickness without stress across the plane at t = {} s: it is stretched or turned inside out \
         beyond what its material can follow in plane stress",
        "ćelija {} u t = {} s nema pozitivnu debljinu bez naprezanja okomito na ravninu: rastegnuta je ili izvrnuta više nego što \
         njezin materijal u ravninskom naprezanju može slijediti",
    ),
    (
        "cell {} with the nodes {}] {~} at rest: det ∂X/∂ξ = {}; allowed: more than {}",
        "ćelija {} s čvorovima {}] {~} u mirovanju: det ∂X/∂ξ = {}; dopušteno: više od {}",
    ),
    (
        "the published program is plane; allowed: dimension = 2",
        "objavljeni program je ravninski; dopušteno: dimension = 2",
    ),
    ("the body has no outline", "tijelo nema obrisa"),
    ("`held` needs `pointer`", "`held` treba `pointer`"),
    (
        "each row of `held` is [press, release] with press < release",
        "svaki redak od `held` je [pritisak, puštanje], pritisak < puštanje",
    ),
    ("`modulus` needs `thickness`", "`modulus` treba `thickness`"),
    ("`thickness` goes with `modulus`, not with `stiffness`", "`thickness` ide uz `modulus`, a ne uz `stiffness`"),
    (
        "the body has nothing to bend: no node between two edges of an outline or chain, no edge between two triangles",
        "tijelo nema što savijati: nijedan čvor između dvaju bridova obrisa ili lanca, nijedan brid između dvaju trokuta",
    ),
    (
        "hinge {} has an edge without length or a triangle without area at rest",
        "zglob {} ima u mirovanju brid bez duljine ili trokut bez površine",
    ),
    // Integrators.
    (
        "nothing holds the body against {~}: {~}; an equilibrium needs a body that is held; hint: pin as many axes of \
         nodes as there are rigid modes, or give it something to rest on",
        "ništa ne drži tijelo protiv: {~} ({~}); ravnoteža treba tijelo koje nešto drži; savjet: pribodi toliko \
         osi čvorova koliko je krutih pomaka, ili mu daj na čemu će ležati",
    ),
    (
        "nothing holds the body against {~}: {~}, since its forces are linear: what turns it turns it without end, and no weight \
         brings it back as it does a pendulum; an equilibrium needs a body that is held; hint: pin as many axes of nodes as \
         there are rigid modes, or take a material for large rotations, such as `neo_hookean`",
        "ništa ne drži tijelo protiv: {~} ({~}), jer su mu sile linearne: što ga zakreće, zakreće ga bez kraja, a težina ga ne vraća \
         kao njihalo; ravnoteža treba tijelo koje nešto drži; savjet: pribodi toliko osi čvorova koliko je krutih pomaka, \
         ili uzmi materijal za velike zakrete, poput `neo_hookean`",
    ),
    (
        "the body is in {} pieces, and nothing holds that of {~} about {#} against {~}: {~}; an equilibrium needs every piece \
         held; hint: pin as many axes of its nodes as it has rigid modes, join it to the others, or leave it out",
        "tijelo ima ovoliko komada: {}, a ništa ne drži onaj ({~}) oko {#} protiv: {~} ({~}); ravnoteža treba da svaki komad nešto \
         drži; savjet: pribodi toliko osi njegovih čvorova koliko ima krutih pomaka, spoji ga s ostalima ili ga izostavi",
    ),
    (
        "the body is in {} pieces, and that of {~} about {#} lies on an obstacle, and neither that nor pins hold it against \
         {~}; an equilibrium needs every piece held; hint: pin an axis of a node for each, or let the obstacle rub (`friction`)",
        "tijelo ima ovoliko komada: {}, a onaj ({~}) oko {#} leži na prepreci, a ni ona ni pribodene točke ne drže ga protiv: {~}; \
         ravnoteža treba da svaki komad nešto drži; savjet: za svaki pribodi os čvora, ili neka prepreka trlja (`friction`)",
    ),
    (
        "the curve of equilibria turns back or sharply aside at {} of the load, however short the step, down to a thousandth of \
         `arc_length`; a branch of another form may begin here; hint: a small force or a shape that leads onto one branch, or \
         the whole load at once, without `arc_length`",
        "krivulja ravnoteža kod {} tereta okreće se natrag ili oštro u stranu, koliko god korak bio kratak, do tisućinke \
         `arc_length`; tu možda počinje grana drugog oblika; savjet: mala sila ili oblik koji vodi na jednu granu, ili sav teret \
         odjednom, bez `arc_length`",
    ),
    (
        "no load acts on what is free at t = {} s, and `arc_length` goes by the part of the load that is on; allowed: weight or \
         loads; hint: without `arc_length` every step ends where pins and gases balance",
        "ništa ne opterećuje ono što je slobodno u t = {} s, a `arc_length` ide po dijelu tereta koji djeluje; dopušteno: težina ili \
         tereti; savjet: bez `arc_length` svaki korak završava gdje su pribodene točke i plinovi u ravnoteži",
    ),
    (
        "the body lies on an obstacle, and neither that nor pins hold it against {~}; an equilibrium needs a body that is held; \
         hint: pin an axis of a node for each, or let the obstacle rub (`friction`)",
        "tijelo leži na prepreci, a ni ona ni pribodene točke ne drže ga protiv: {~}; ravnoteža treba tijelo koje nešto drži; \
         savjet: za svaki pribodi os čvora, ili neka prepreka trlja (`friction`)",
    ),
    ("translation along {}, {~}", "pomak duž {}, {~}"),
    ("translation along {}", "pomak duž {}"),
    ("rotation about an axis along {}, {~}", "zakret oko osi duž {}, {~}"),
    ("rotation about an axis along {}", "zakret oko osi duž {}"),
    ("rotation", "zakret"),
    (
        "steps that counted though they had not converged have made the body a hundred times as large as it was: more substeps, \
         or `when_not_converged = \"halve\"`",
        "koraci koji su vrijedili iako nisu konvergirali učinili su tijelo stotinu puta većim: više podkoraka, ili \
         `when_not_converged = \"halve\"`",
    ),
    (
        "`accuracy` is \"real_time\", whose steps leave a part out of balance; `{}` damps nothing, and would add it up without \
         end; allowed: \"exact\"; hint: `backward_euler` and `bdf2` have a real-time setting",
        "`accuracy` je \"real_time\", čiji koraci dio ostave izvan ravnoteže; `{}` ništa ne prigušuje i zbrajao bi ga bez kraja; \
         dopušteno: \"exact\"; savjet: `backward_euler` i `bdf2` mogu u stvarnom vremenu",
    ),
    (
        "`accuracy` is \"real_time\", whose steps leave a part out of balance; `{}` with `spectral_radius` = {} damps slow motions \
         hardly, and hands that part on with the acceleration that it remembers; allowed: \"exact\"; hint: `backward_euler` and \
         `bdf2` have a real-time setting",
        "`accuracy` je \"real_time\", čiji koraci dio ostave izvan ravnoteže; `{}` uz `spectral_radius` = {} spora gibanja jedva \
         prigušuje i predaje taj dio dalje s ubrzanjem koje pamti; dopušteno: \"exact\"; savjet: `backward_euler` i `bdf2` mogu u \
         stvarnom vremenu",
    ),
    (
        "`poissons_ratio` is {}, with which `mooney_rivlin` is not convex, whatever the `mooney_share`; allowed: at least {}, so that \
         {} <= ν/(1 − 2ν); hint: a smaller `mooney_share` allows a smaller one, down to 0",
        "`poissons_ratio` je {}, s čime `mooney_rivlin` nije konveksan, koliki god bio `mooney_share`; dopušteno: najmanje {}, tako da \
         je {} <= ν/(1 − 2ν); savjet: manji `mooney_share` dopušta manji, sve do 0",
    ),
    (
        "`linear_solver` is \"matrix_free\", and `accuracy` is \"real_time\", which keeps a matrix; allowed with it: \"auto\", \
         \"conjugate_gradients\", \"cholesky\"",
        "`linear_solver` je \"matrix_free\", a `accuracy` je \"real_time\", koji čuva matricu; dopušteno uz njega: \"auto\", \
         \"conjugate_gradients\", \"cholesky\"",
    ),
    (
        "`linear_solver` is \"matrix_free\", and `arc_length` factors a matrix; allowed with it: {}",
        "`linear_solver` je \"matrix_free\", a `arc_length` rastavlja matricu; dopušteno uz njega: {}",
    ),
    (
        "`arc_length` is given, and pins do not hold the body, which nothing presses onto obstacles where the curve begins, without \
         any load; allowed: pins that hold it, or the whole load at once, in as many `load_steps` as it takes",
        "`arc_length` je zadan, a tijelo ne drže pribodene točke, i ništa ga ne pritišće na prepreke gdje krivulja počinje, bez \
         ikakva tereta; dopušteno: pribodene točke koje ga drže, ili cijeli teret odjednom, u koliko god `load_steps` treba",
    ),
    (
        "a frame has at most {} substeps: a shorter one, a softer or heavier body, or another integrator",
        "sličica ima najviše {} podkoraka: pomaže kraća sličica, mekše ili teže tijelo, ili drugi integrator",
    ),
    (
        "more substeps, or `accuracy = \"exact\"`; the step was already halved down to 1/256",
        "više podkoraka, ili `accuracy = \"exact\"`; korak je već prepolovljen do 1/256",
    ),
    (
        "more substeps, or more `iterations`; the step was already halved down to 1/256",
        "više podkoraka ili više `iterations`; korak je već prepolavljan do 1/256",
    ),
    (
        "more substeps, more `iterations`, or `when_not_converged = \"halve\"`",
        "više podkoraka, više `iterations`, ili `when_not_converged = \"halve\"`",
    ),
    (
        "positions have sixteen digits here, which leave {} m and forces of {} N open: a larger `tolerance`, a scene nearer to the \
         origin, larger cells, or a body that is less stiff",
        "položaji ovdje imaju šesnaest znamenki, koje ostavljaju otvorenim {} m i sile od {} N: veći `tolerance`, prizor bliže \
         ishodištu, veće ćelije, ili manje kruto tijelo",
    ),
    ("a shorter `arc_length`, or more `iterations`", "kraći `arc_length`, ili više `iterations`"),
    (
        "more `iterations`; the load was already halved down to 1/256: where a body gives way, `arc_length` follows it through its snap",
        "više `iterations`; teret je već prepolavljan do 1/256: gdje tijelo popusti, `arc_length` ga prati kroz preskok",
    ),
    (
        "more `iterations`; the load was already halved down to 1/256: a rule that steps through time with damping finds a place to rest",
        "više `iterations`; teret je već prepolavljan do 1/256: pravilo koje prigušeno korača kroz vrijeme nađe gdje će tijelo mirovati",
    ),
    (
        "`when_not_converged = \"halve\"`, more `load_steps`, or more `iterations`; where a body gives way, `arc_length`",
        "`when_not_converged = \"halve\"`, više `load_steps`, ili više `iterations`; gdje tijelo popusti, `arc_length`",
    ),
    (
        "`when_not_converged = \"halve\"`, more `load_steps`, or more `iterations`",
        "`when_not_converged = \"halve\"`, više `load_steps`, ili više `iterations`",
    ),
    (
        "`{}` did not converge in {~} at t = {} s, beyond {~}: the forces are out of balance by {} N, and the \
         last correction was {} m; allowed: {} m",
        "`{}` nije konvergirao ({~}) u t = {} s, iza {~}: sile su izvan ravnoteže za {} N, a zadnji je popravak \
         {} m; dopušteno: {} m",
    ),
    (
        "`{}` did not converge in {~} at t = {} s, {~}: the forces are out of balance by {} N, and the last correction was {} m; \
         allowed: {} m",
        "`{}` nije konvergirao ({~}) u t = {} s, {~}: sile su izvan ravnoteže za {} N, a zadnji je popravak {} m; dopušteno: {} m",
    ),
    (
        "from a state with {} of {} cells flat or inside out",
        "iz stanja u kojem su ćelije bez volumena ili izvrnute ({} od {})",
    ),
    (
        "`{}` did not converge in {~} at t = {}: the forces are out of balance by {} N, and the last correction was \
         {} m; allowed: {} m",
        "`{}` nije konvergirao ({~}) u t = {}: sile su izvan ravnoteže za {} N, a zadnji je popravak {} m; dopušteno: \
         {} m",
    ),
    // The world.
    ("there is no such model", "nema takvog modela"),
    ("there is no such integrator", "nema takvog integratora"),
    ("there is no such body", "nema takvog tijela"),
    ("there is no such command", "nema takve naredbe"),
    (
        "the selected nodes hold no whole facet of the boundary; allowed: all nodes of one facet at least",
        "izabrani čvorovi ne drže nijednu cijelu stranicu granice; dopušteno: barem svi čvorovi jedne stranice",
    ),
    (
        "cell {} belongs to the models {} and {} of the body, whose stiffness would add up; allowed: every cell in one `{}` \
         model. Name groups without common cells by `cells`",
        "ćelija {} pripada modelima {} i {} tijela, čije bi se krutosti zbrojile; dopušteno: svaka ćelija u jednom modelu `{}`. \
         S `cells` imenuj skupine bez zajedničkih ćelija",
    ),
    (
        "{} of {} cells, the first of them cell {}, are in none of the groups {} of the models: they would have mass and no \
         stiffness; allowed: every cell in one model",
        "{} od {} ćelija, prva od njih {}, nije ni u jednoj skupini {} modela: imale bi masu, a ne i krutost; dopušteno: svaka \
         ćelija u jednom modelu",
    ),
    (
        "`mass` is \"consistent\", which couples the accelerations of the nodes of a cell, and `{}` moves every node by its own \
         mass; allowed: \"lumped\"; hint: consistent masses go with backward_euler, bdf2, implicit_midpoint and newmark",
        "`mass` je \"consistent\", što povezuje ubrzanja čvorova ćelije, a `{}` miče svaki čvor njegovom masom; dopušteno: \
         \"lumped\"; savjet: konzistentne mase idu uz backward_euler, bdf2, implicit_midpoint i newmark",
    ),
    (
        "`mass` is \"consistent\", and there are obstacles, whose impacts act on the masses of single nodes; allowed: \
         \"lumped\"; hint: consistent masses go with obstacles in `equilibrium`, which knows no impacts",
        "`mass` je \"consistent\", a ima prepreka, čiji sudari djeluju na mase pojedinih čvorova; dopušteno: \
         \"lumped\"; savjet: konzistentne mase idu uz prepreke u `equilibrium`, gdje sudara nema",
    ),
    (
        "`mass` is \"consistent\", and `node_mass` = {} kg gives every node the same mass, whatever its cells; allowed: \"lumped\"; \
         hint: `mass` or `density` of the body goes with consistent masses",
        "`mass` je \"consistent\", a `node_mass` = {} kg daje svakom čvoru istu masu, kakve god bile ćelije; dopušteno: \"lumped\"; \
         savjet: uz konzistentne mase ide `mass` ili `density` tijela",
    ),
    (
        "all nodes of the body are held along every axis, and nothing of it can swing; allowed: a node that is free along an axis; \
         hint: another body, or fewer pins",
        "svi čvorovi tijela pribodeni su po svim osima, i ništa na njemu ne može titrati; dopušteno: čvor slobodan po nekoj osi; \
         savjet: drugo tijelo ili manje pribodenih točaka",
    ),
    (
        "{} modes of a body with {} free coordinates take about {} bytes; allowed: at most {} bytes; hint: fewer modes",
        "{} oblika titranja tijela s ovoliko slobodnih koordinata: {} traži oko {} bajtova; dopušteno: najviše {} bajtova; \
         savjet: manje oblika",
    ),
    (
        "the bodies of the scene take about {} bytes, `{}` {} of them; allowed: {}; hint: a coarser mesh, an explicit integrator, or \
         `linear_solver = \"matrix_free\"`",
        "tijela prizora traže oko {} bajtova, `{}` od toga {}; dopušteno: {}; savjet: grublja mreža, eksplicitni integrator ili \
         `linear_solver = \"matrix_free\"`",
    ),
    ("body `{}` has no model `{}`; it has {}", "tijelo `{}` nema model `{}`; ima {}"),
    (
        "body `{}` follows the integrator of the scene: integrator.{}",
        "tijelo `{}` slijedi integrator prizora: integrator.{}",
    ),
    ("there is no collider {}; allowed: {}", "nema prepreke {}; dopušteno: {}"),
    ("there is no body {}; did you mean `{}`?", "nema tijela {}; misliš li `{}`?"),
    ("there is no body `{}`", "nema tijela `{}`"),
    ("`{}` is {#}; allowed: {~}", "`{}` je {#}; dopušteno: {~}"),
    ("is {#}; allowed: {~}", "je {#}; dopušteno: {~}"),
    (
        "the forces around the state are not finite, so no stable step can be given{~}",
        "sile oko stanja nisu konačne, pa se ne može dati stabilni korak{~}",
    ),
    (
        "; allowed: forces, stiffnesses and their ratios to the masses of nodes below 1e300; hint: {~}its lightest node has {} kg",
        "; dopušteno: sile, krutosti i njihovi omjeri prema masama čvorova ispod 1e300; savjet: {~}najlakši čvor ima {} kg",
    ),
    (
        "the forces around the state are not finite, so no stable step can be given",
        "sile oko stanja nisu konačne, pa se ne može dati stabilni korak",
    ),
    (
        "body `{}` diverged: node {} left {~} in the substep from t = {} s; the world is at its last good frame, t = {} s",
        "tijelo `{}` je divergiralo: čvor {} napustio je {~} u podkoraku od t = {} s; svijet je na zadnjoj dobroj sličici, t = {} s",
    ),
    (
        "body `{}`: {~}; the world is at its last good frame; hint: {~}",
        "tijelo `{}`: {~}; svijet je na zadnjoj dobroj sličici; savjet: {~}",
    ),
    ("body `{}`: {~}; the world is at its last good frame", "tijelo `{}`: {~}; svijet je na zadnjoj dobroj sličici"),
    // Warnings.
    (
        "the step h = {} s of `{}` is unstable for body `{}`: the largest stable step is {} s (stiffness ω = {} rad/s, damping {} \
         1/s); allowed: h <= {}; hint: {~}",
        "korak h = {} s integratora `{}` nestabilan je za tijelo `{}`: najveći stabilni korak je {} s (krutost ω = {} rad/s, \
         prigušenje {} 1/s); dopušteno: h <= {}; savjet: {~}",
    ),
    // What stands in a scene.
    ("`{}` is missing in `{}`", "`{}` nedostaje u `{}`"),
    ("`{}` is missing", "`{}` nedostaje"),
    ("`{}` is {#}", "`{}` je {#}"),
    ("`{}` is {~}", "`{}` je {~}"),
    // Files.
    ("the file `{}` is not there", "datoteke `{}` nema"),
    ("{} cannot be read", "{} se ne može pročitati"),
];
