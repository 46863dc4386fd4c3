# What deserves attention in a world.

## Difference

part-difference-Gained = previše
part-difference-Lost = premalo

## ErrorHint

part-error_hint-RealTime = kod implicitnih pravila neobjašnjeno je što u jednadžbama ostaje van ravnoteže: `accuracy = "exact"` ili više podkoraka
part-error_hint-Exact = kod implicitnih pravila neobjašnjeno je što u jednadžbama ostaje van ravnoteže: manji `tolerance` ili više podkoraka
part-error_hint-Contact = tijela su udarila o prepreke ili jedna o druga, a ondje pada razmjerno koraku kod svakog pravila: više podkoraka
part-error_hint-ContactOfOthers = tijela su udarila o prepreke ili jedna o druga, a ondje pada razmjerno koraku kod svakog pravila; najmanja je kod `verlet`
part-error_hint-Explicit = s više podkoraka je manja, a manja je i kod pravila višeg reda

## DampingHint

part-damping_hint-Substeps = s više podkoraka je manje
part-damping_hint-Undamped = s više podkoraka je manje, a `implicit_midpoint` i `newmark` sami uzimaju manje
part-damping_hint-RealTime = s više podkoraka je manje, a `bdf2` sam uzima manje
part-damping_hint-Radius = manje je s više podkoraka ili s većim `spectral_radius`
part-damping_hint-Damped = s više podkoraka je manje, a `backward_euler` prigušuje što bi raslo
part-damping_hint-Exact = `accuracy = "exact"` to sprečava; s više podkoraka koraci u stvarnom vremenu mogu dodati i više

## BudgetHint

part-budget_hint-Stiff = tijelo je prekruto ili pretanko za korak: više podkoraka, `linear_solver = "cholesky"`, ili `accuracy = "exact"`
part-budget_hint-Factored = tijelo je prekruto ili pretanko za korak: više podkoraka ili `accuracy = "exact"`
part-budget_hint-Touching = dodir mijenja sile tijekom koraka, ili je tijelo prekruto ili pretanko za korak: više podkoraka, veći `iterations` ili `accuracy = "exact"`

## CellHint

part-cell_hint-Smaller = manje ćelije, ili manje onoga što ih drobi
part-cell_hint-Farther = manje ćelije, ili materijal koji takve ćelije vraća iz veće daljine (`fixed_corotated`)
part-cell_hint-Material = ili materijal koji takve ćelije vraća (`stable_neo_hookean`, `fixed_corotated`)

## BendingHint

part-bending_hint-Quadratic = kvadratne ćelije (`order = 2`), četverokuti ili heksaedri
part-bending_hint-Hexahedra = heksaedri ili kraće ćelije

## UnfoldHint

part-unfold_hint-Unfold = {""}, ili `unfold = true` u `[world]`

## InvertedCells

part-inverted_cells-Certain = { $count ->
        [one] { $count } ćelija
        [few] { $count } ćelije
       *[other] { $count } ćelija
    }
part-inverted_cells-Perhaps = možda { $count ->
        [one] { $count } ćelija
        [few] { $count } ćelije
       *[other] { $count } ćelija
    }
part-inverted_cells-Both = ćelija { $count } i možda još { $perhaps }

## Lay

part-lay-Inside = bio je { $depth } m u prvoj
part-lay-Between = bio je gdje se sreću

## Remedy

part-remedy-Moved = pomaknuto za ({ $shift }) m bilo bi slobodno
part-remedy-Nowhere = nijedan pomak duž ploha oko njega ne bi ga oslobodio

## WorstCell

part-worst_cell-Cell = {""}; ćelija najdalje od svojeg obujma je { $cell } tijela `{ $body }`, J = { NUMBER($ratio, maximumSignificantDigits: 5) }

## WorldWarning

limit-force-ForcesLimited = sile su skraćene na `world.largest_force`
limit-velocity-VelocitiesLimited = brzine su skraćene na `world.largest_velocity`
limit-drag-PullsLimited = vuče su skraćene na svoju `largest_force`, a gdje prizor šuti na silu opruge rastegnute za deset veličina tijela
limit-distance-BodiesLost = tijela su otišla dalje od `world.largest_distance` i uklonjena su
ledger-numerical_damping-TakenByRules = implicitna su pravila sama uzela { $energy } J (`loss_numerical`), više od dvadesetine energije gibanja i više nego prigušenje, trenje i udari zajedno: što je brzo za korak nestaje zbog pravila, a ne po zakonu fizike
    .hint = { $help }
ledger-numerical_damping-MadeByRules = implicitna su pravila sama dodala { $energy } J (`loss_numerical`), više od dvadesetine energije gibanja: što je brzo za korak raste zbog pravila, a ne po zakonu fizike
    .hint = { $help }
ledger-closure-Unexplained = sličica je završila s više od desetine energije gibanja neobjašnjene (`closure`), do kraja { $energy } J { $difference }: pogreška integratora; { $help }
step-not_converged-Accepted = korak je vrijedio iako nije konvergirao: `when_not_converged` je `"accept"`, ili se trenje uz barijeru nakon trideset krugova još mijenjalo za više od tisućinke
    .hint = više podkoraka
step-halved-Halved = korak od { $h } s, u statici ono što on dodaje teretu i putovima pribadača, učinjen je u dvije polovice, a one opet gdje je trebalo, do { $shortest } s, dijela od 1/{ $parts }: Newtonova metoda nije konvergirala preko cijeloga, ili neki model ondje nema smisla (`when_not_converged = "halve"`, ili u stvarnom vremenu); rezultat je onaj tako kratkih koraka na tom mjestu, zbog toga nije lošiji, a trajao je dulje
    .hint = više podkoraka, u statici više `load_steps` ili sličica, štedi uzaludne pokušaje
step-cut_off-CutOff = korak u stvarnom vremenu potrošio je svoje, ili toliko umnožaka da u sporim gibanjima može ostati mnogo: sile izvan ravnoteže koje bi pojedine čvorove pomaknule do { $left } m
    .hint = { $help }
statics-blurred-Estimated = ravnoteža je nađena gdje su sile male kao njihovo zaokruživanje, iako bi ono što od njih ostaje još pomaknulo čvorove do { $error_estimate } m: položaji imaju šesnaest znamenki, a tijelo je tako vitko, ćelije tako tanke ili ishodište tako daleko da je to ono što one ostavljaju otvorenim; što je u rezultatu manje, slučajno je
    .hint = ćelije manje duge prema debljini, ili prizor u ishodištu
conditioning-Conditioning = korak tijela tako krutog za svoju masu da zaokruživanje njegovih položaja, koji imaju šesnaest znamenki, stvara sile do { NUMBER($times, maximumSignificantDigits: 3) } puta veće od tereta čvora: njegovo gibanje kao cjeline uravnoteženo je zasebno i točno je, čvorovi su gdje pripadaju osim zadnje znamenke položaja, a naprezanja su slučajna
    .hint = prizor bliže ishodištu, veće ćelije, ili manje kruto tijelo
step-disturbed-Disturbed = tijelo koje je mirovalo spljošteno, izvrnuto ili presavijeno nasumce je poremećeno, za 1e-4 svoje veličine, zatim za stotinu i za desetinu
    .hint = što je iz takva oblika izašlo, njiše se dok ga nešto ne priguši, najbrže uz `backward_euler` ili uz prigušenje (`damping`) materijala
step-odd_rest-DegenerateRest = tijelo je mirovalo spljošteno, izvrnuto ili presavijeno, u ravnoteži koju ni poremećaj do desetine njegove veličine nije prekinuo{ $worst }
    .hint = drukčiji početak, ili materijal koji takve ćelije vraća (`fixed_corotated`)
restore-no_force-NoForce = snimka stanja ne sadrži zakone sile koje je dao program, a tijelo je imalo jedan: zadaj ga opet (`World::add_force`)
statics-load_left-LoadLeft = račun završava prije nego je nanesen cijeli teret: tijelo `{ $body }` u ravnoteži je pod dijelom { $part } (`load_factor`), i to pokazuje zadnje stanje
    .hint = više sličica ili dulji `arc_length`
units-sag-Sag = tijelo `{ $body }` od { $mass } kg ulegnulo bi se pod svojom težinom oko { NUMBER($sag, maximumSignificantDigits: 2) } m, više od svoje veličine od { $size } m: jesu li jedinice pomiješane (metri, kilogrami, njutni po metru)?
contact-starts_inside-StartsInside = tijelo `{ $body }` počinje u prepreci { $collider } ({ $kind }), čvorova: { $nodes }, najdublji je čvor { $deepest }, { $depth } m; { $remedy }
contact-starts_across-StartsAcross = tijelo `{ $body }` počinje preko prepreke { $collider } ({ $kind }), koja nema unutrašnjost: svaki čvor ostaje na strani na kojoj počinje, pa prepreka stišće tijelo
    .hint = pomaknite tijelo ili prepreku
contact-starts_overlapping-StartsOverlapping = tijela počinju jedno u drugome ili jedno preko drugoga, parova: { $pairs }, prva dva su `{ $body }` i `{ $other }`, kod ({ $position }) m
    .hint = razmakni tijela; dodir polako razmiče puna tijela (`recovery_speed`), a otvorene plohe i žice ostavlja prekriženima
contact-none-NoContact = u t = { $time } s tijela prolaze jedna kroz druga, parova: { $pairs }, prva dva su `{ $first }` i `{ $second }`
    .hint = odjeljak `[contact]` drži tijela razdvojenima
contact-mixed-Mixed = u t = { $time } s tijelo `{ $first }` ({ $first_rule }) dodiruje tijelo `{ $second }` ({ $second_rule }): dodir se rješava za oba zajedno, ali svako korača po svojem pravilu, pa za par ne vrijede ni red ni prigušenje nijednoga; broji se po sličici i paru tijela
    .hint = jedan integrator za tijela koja se dodiruju
cells-slender-Slender = tijelo `{ $body }` presavija se ili uvija prekruto: najdulji bridovi njegovih ćelija dugi su prosječno { NUMBER($length, maximumSignificantDigits: 3) } m, { NUMBER($times, maximumSignificantDigits: 3) } puta koliko je debelo ({ NUMBER($thickness, maximumSignificantDigits: 3) } m); uz { $limit } puta prve su frekvencije ploča izmjerene { $error } % previsoke, a dalje rastu
    .hint = { $help }
cells-inverted-Inverted = u t = { $time } s izvrnuto je: { $cells }; prva je ćelija { $cell } tijela `{ $body }` s J = { $ratio }
    .hint = više podkoraka, { $help }{ $unfold }
cells-other_balance-OtherBalance = u t = { $time } s { $count ->
        [1] 1 tijelo ima u ćelijama više energije nego što je sile na njemu objašnjavaju
       *[other] više energije u ćelijama nego što je sile na njima objašnjavaju ima tijela: { $count }
    }, u drugoj ravnoteži nego što je ona vlastitog oblika: preskočilo, presavijeno, izvrnuto ili zavrnuto; prvo je tijelo `{ $body }` s { NUMBER($energy, maximumSignificantDigits: 4) } J, od toga objašnjeno { NUMBER($accounted, maximumSignificantDigits: 4) } J, V/V₀ = { NUMBER($volume, maximumSignificantDigits: 4) }, i ćelijom { $cell } s J = { NUMBER($ratio, maximumSignificantDigits: 4) }
    .hint = ako to nije namjera, počni u vlastitom obliku, s više prigušenja ili podkoraka{ $unfold }
law-turned-Turned = u t = { $time } s ćelija { $cell } tijela `{ $body }` zakrenuta je za { NUMBER($angle, maximumSignificantDigits: 3) }°, što njezin zakon `linear` uzima za deformaciju od { NUMBER($strain, maximumSignificantDigits: 3) } %; broji se po okviru i tijelu
    .hint = `corotated`, isti zakon u osima koje se okreću sa svakom ćelijom
contact-no_room-NoRoom = u t = { $time } s prepreke { $first } ({ $first_kind }) i { $second } ({ $second_kind }) nisu ostavile mjesta tijelu `{ $body }`: čvor { $node } { $lay }, brojeno po slici i tijelu; vođene prepreke ne smiju se sresti
command-no_body-CommandsEnded = naredbe tijelu `{ $body }` završile su kad je uklonjeno
command-no_body-OtherCommandsEnded = naredbe drugim tijelima završile su kad su ta uklonjena
step-no_stable_step-NoStableStep = `{ $integrator }` nema stabilnog koraka za tijelo `{ $body }` (ω = { $omega } rad/s): jedno gibanje raste kao exp({ $growth } t)
step-outgrown-Outgrown = u t = { $time } s najveći stabilni korak tijela `{ $body }` pao je na { $limit } s, ispod h = { $h } s: stisnuto ili rastegnuto kruće je nego u mirovanju; ondje vrijedi podkoraka >= { $substeps }
