# What models refuse, and what deserves attention in them.

## Boundary elements

model-no_surface-NoSurface = tijelo nema zatvorenu granicu: crta je, ploha, lanac ili čvor
    .allowed = zatvoreni obrisi u ravnini, zatvorene plohe u prostoru
model-open_surface-Open = { $problem }
    .allowed = zatvorena granica
    .hint = `cap = true` zatvara plohu iz datoteke
model-not_manifold-NotManifold = { $problem }
    .allowed = granica koja svugdje ima unutrašnjost i vanjštinu
model-orientation-Orientation = { $problem }
    .allowed = strane koje sve gledaju na istu stranu
model-crossing_surface-Crossing = parova strana koji se sijeku ili dodiruju: { $count }, prve su strane { $first } i { $second }
    .allowed = granica koja ne susreće samu sebe
model-degenerate_facet-Degenerate = strana { $facet } ima mjeru { $measure } uz brid od { $edge } m
    .allowed = više od 1e-10 brida (u prostoru njegova kvadrata)
model-inner_nodes-InnerNodes = { $count } od { $nodes } čvorova nije na granici, prvi je čvor { $first }
    .allowed = samo čvorovi granice, jer metoda druge ne poznaje
    .hint = ploha bez ispune, kao `polygon` ili `svg` u ravnini, a `box`, `icosphere` ili `surface` u prostoru
model-several_solids-SeveralSolids = granica obuhvaća tijela koja se ne dodiruju: { $solids }
    .allowed = jedno, sa šupljinama
    .hint = svakome vlastito tijelo
model-nested_exterior-NestedExterior = `exterior` je istina, a strana { $facet } pripada granici unutar druge
    .allowed = šupljine jedna pokraj druge
limit-memory-TooMany = granica ima { $nodes } vrhova, čije guste matrice pri nastanku zauzimaju oko { $bytes } bajtova
    .allowed = najviše { $most } vrhova
    .hint = grublja ploha (`spacing`) ili `fem` na njezinoj ispuni
model-not_on_the_page-Page = stranica ne računa rubne elemente
    .hint = studio i naredbeni redak računaju ih
run-broken_off-Ended = priprema je prekinuta
model-singular-Singular = jednadžbe granice nemaju rješenja: { $reason }
    .hint = strane ujednačenije veličine
part-no_solution-Singular = G je singularna
part-no_solution-NotFinite = krutost nije konačna
part-no_solution-NegativeOfMany = krutost ima negativnih svojstvenih vrijednosti, a vrhova je više od 1000
part-no_solution-ManyNegative = više od dvadesetine krutosti ima negativne svojstvene vrijednosti
mesh-turned-Turned = strane su okrenute tako da je tijelo iza svake: one granice unutar druge omeđuju šupljinu

## Shape matching

model-no_group-NoGroup = mreža nema skupinu čvorova `{ $name }`
    .allowed = { $known }
    .hint = `region` čini skupove bilo kojeg tijela
model-cluster_misses-Misses = { $missed } od { $nodes } čvorova nije ni u jednom skupu, prvi je čvor { $first }
    .allowed = svaki čvor barem u jednom
    .hint = imenuj i skupinu svih ostalih
model-region-TooManyRegions = `region` je { $region } m, što od { $nodes } čvorova čini { $boxes } kutija
    .allowed = najviše { $most } kutija
    .hint = kutija duž svake osi drži nekoliko čvorova
model-goal_step-GoalStep = `goal_step` je { $share }, a `scheme` je "potential", čija krutost ne ovisi o koraku
    .allowed = `stiffness`
    .hint = uz ovaj korak `stiffness = { $stiffness }` znači isto, a `scheme = "as_published"` uzima `goal_step`
model-step_changed-StepChanged = podkorak je { $now } s, a `goal_step` vrijedi za { $declared } s koje je zadao prizor
    .allowed = taj korak
    .hint = `stiffness = { $stiffness }` znači isto uz svaki korak
part-no_potential-NoPotentialOfGoal = `scheme` je "as_published", čiji cilj, prilagođeno preslikavanje podijeljeno korijenom svoje determinante, nije gradijent nijednog potencijala; `scheme = "potential"` ima oboje
shape_matching-mirrored-Mirrored = skup je bio zrcaljen, brojeno po podkoraku i skupu: zakreti ne vraćaju zrcaljeni oblik, pa skupovi koji se preklapaju i svi su zrcaljeni mogu ostati presavijeni
    .hint = manje skupova, i većih

## Finite volumes

model-no_cells-NoCells = tijelo nema ćelija: obris je, ploha ili lanac
    .allowed = trokuti, četverokuti, tetraedri i heksaedri, kakve imaju `grid`, oblici iz datoteka s `filling` i mreže tijela
model-quadratic_cells-Quadratic = tijelo ima kvadratnih ćelija: { $count }, a one ovdje nemaju dualnih strana
    .allowed = linearne ćelije
    .hint = `order = 1` tijelu
model-inverted_cell-InvertedCell = ćelija { $cell } u mirovanju nema obujma ili je izvrnuta: det ∂X/∂ξ = { $determinant } ćelije duge { $size } m
    .allowed = više od 1e-12 njezine veličine
model-locking-Locks = `poissons_ratio` je { $ratio } za trokute ili tetraedre, koji se blizu nestlačivosti ukoče
    .allowed = najviše { $most }
    .hint = `locking = "accept"` uzima ih kakvi jesu, a `fem` ima `order = 2` i `locking = "nodal_volume"`
scene-unknown_name-NoMaterial = nema materijala `{ $name }`
part-no_potential-NoPotentialOfFaces = sile četverokuta i heksaedara, s F u sredini svake dualne strane, nisu gradijent nijedne energije; trokuti i tetraedri je imaju (`simplices = true`, `order = 1`)
run-no_thickness-NoThickness = ćelija { $cell } u t = { $time } s nema pozitivnu debljinu bez naprezanja okomito na ravninu: rastegnuta je ili izvrnuta više nego što njezin materijal u ravninskom naprezanju može slijediti

## Finite differences

model-not_a_grid-NotAGrid = tijelo nije pravilna rešetka
    .allowed = line, ring, polyline, sheet i rešetka četverokuta ili heksaedara
model-not_rectangular-NotRectangular = ćelija { $cell } odstupa od pravokutnika za { $deviation } svojeg razmaka
    .allowed = najviše 1e-6
model-uneven_grid-Uneven = ćelija { $cell } ima razmak od { $spacing } m, a ćelija 0 od { $first } m
    .allowed = jednaki razmaci
finite_difference-folded-Folded = rubovi krivulje ili plohe kraći su od 0.58 svoje duljine u mirovanju, gdje njihov zakon popušta, ili su presavijeni na susjedne, brojeno u zadnjem stanju: mogu tako ostati
    .hint = manja opterećenja, ili kraći koraci prije nego što se presavije; opruge (`mass_spring`) opiru se svakom stiskanju
model-no_thickness-NoThickness = krivulja ili ploha treba `thickness`
    .allowed = > 0 m
model-solid_thickness-SolidThickness = `thickness` pripada krivuljama i plohama; puno tijelo je nema
model-torsion_of_surface-TorsionOfSurface = `torsion` pripada krivuljama (`line`, `ring`, `polyline`); ploha ili puno tijelo opire se vlastitom smicanju
model-no_torsion-NoFrame = krivulja je u čvoru { $node } ravna, pa joj torzija ondje nema vrijednosti
    .hint = izostavi `torsion` ili savij oblik u mirovanju
model-zero_length-NoLength = brid { $edge } u mirovanju nema duljine
    .allowed = > 0 m

## Pressure

pressure-limited-Limited = plin je zadržan na `largest_pressure`, ili na tlaku pri `smallest_volume`, brojano po podkoraku i tijelu
pressure-inverted-Inverted = komora nije obuhvaćala ništa ili je bila izvrnuta, brojano po podkoraku i tijelu: njezin je plin otvara kako kaže opis; obris koji je prošao kroz sebe može takav ostati

## Films

video-size-Size = film od { $width } puta { $height } piksela nije moguć
    .allowed = 1 do 16384 po stranici, a ukupno 35 milijuna
video-frame_size-FrameSize = sličica ima { $width } puta { $height } piksela, a film { $film_width } puta { $film_height }
video-rate-Rate = film ne može imati { $rate } sličica u sekundi
    .allowed = 0.0001 do 10000
video-empty-Empty = film treba barem jednu sličicu
write-failed-Write = film se ne može zapisati: „{ $reason }”
