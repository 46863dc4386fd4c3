# What readers of shapes and makers of bodies from shapes say.

## Change

part-change-Lost = { $off } { $unit } ({ $percent } %) od { $whole } { $unit } manje
part-change-Added = { $off } { $unit } ({ $percent } %) od { $whole } { $unit } više

## ThinCause

part-thin_cause-Corner = sâm obris ondje ima kut od { $angle }°
part-thin_cause-Finer = obris je ondje finiji od { $spacing }
part-thin_cause-Unfinished = profinjavanje je dodalo onoliko čvorova koliko smije

## ShapeHint

part-shape_hint-SmallerSpacing = uzmi manji { $spacing }
part-shape_hint-LargerSpacing = uzmi veći { $spacing } ili crtež s manje točaka
part-shape_hint-SpacingKeeps = { $spacing } čuva obujam unutar { $percent } %
part-shape_hint-SmallerRemesh = uzmi manji { $remesh }
part-shape_hint-RemeshWorks = { $remesh } uspijeva
part-shape_hint-NoRemeshWorks = uzmi manji { $remesh }: nijedna iskušana duljina od { $length } m naviše ne uspijeva
part-shape_hint-RoundCorner = zaobli ga u crtežu, ili uzmi { $lattice }
part-shape_hint-SmallerOrLattice = uzmi manji { $spacing }, ili { $lattice }
part-shape_hint-LargerOrLattice = uzmi veći { $spacing }, ili { $lattice }
part-shape_hint-FinerOutline = uzmi manji { $spacing }, veći { $size }, { $drop_below } ili { $lattice }
part-shape_hint-Overlap = { $union } zadržava što pokriva bilo koji, { $parity } što obuhvaća neparan broj njih
part-shape_hint-Millimetres = datoteka je možda u milimetrima: { $scale }; { $size } zadaje duljinu
part-shape_hint-Kilometres = datoteka je možda u kilometrima: { $scale }; { $size } zadaje duljinu
part-shape_hint-Size = { $size } zadaje duljinu
part-shape_hint-CapOrSheet = { $cap } zatvara je, { $sheet } zadržava je kao tkaninu
part-shape_hint-Weld = vrhova: { $count }, { $count ->
        [one] leži
       *[other] leže
    } na mjestu drugoga: { $weld } spaja ih; ili { $cap }, { $sheet }

## ShapeError

scene-unknown_kind-ReadsNoFile = `{ $kind }` ne čita datoteku
shape-format-Ending = datoteke sa završetkom `.{ $ending }` ne mogu se pročitati
    .allowed = datoteka sa završetkom .obj, .stl, .ply, .gltf, .glb, { $others }
shape-encoding-Encoding = bajt { $byte } nije UTF-8
    .allowed = tekst u UTF-8
    .hint = spremi ga kao UTF-8
scene-dimension-Dimension = taj oblik ne postoji u { $dimension }D
scene-shape-RemeshCrosses = s bridovima od { $length } m ploha bi sjekla samu sebe
    .allowed = duljina ispod najfinijih dijelova plohe
scene-shape-RemeshEncloses = s bridovima od { $length } m ploha bi obuhvaćala { $part } svojeg obujma
    .allowed = duljina koja čuva obujam unutar { $percent } %
shape-no_area-NoOutline = datoteka nema zatvorenog obrisa
    .allowed = obrisi koji obuhvaćaju površinu, veličine od 1e-150 do 1e150
shape-no_area-NoneLeft = nijedan obris ne ostaje
limit-nodes-TooFineOutline = čvorova na razmaku od { $spacing } m bilo bi { $nodes }
    .allowed = od { $least } m naviše: najviše { $most } čvorova

## ShapeNotice

shape-lost_volume-Filling = popunjavanje daje ovo: { $change }
    .allowed = { $warned } % obujma, iznad 25 % je pogreška
shape-lost_volume-Remeshed = bridovi od { $length } m daju ovo: { $change }
shape-thinned-Thinned = od { $given } { $given ->
        [1] točke
       *[other] točaka
    } datoteke nastaje { $nodes } čvorova, na razmaku od { $spacing } m: { $change }
    .hint = manji { $finer } čuva sitnije pojedinosti, { $lattice } nosi ih sve
shape-thinned-Coarse = { $nodes } čvorova na razmaku od { $spacing } m daje ovo: { $change }
    .hint = manji { $finer } čuva sitnije pojedinosti, { $lattice } nosi ih sve
shape-nested-Nested = obrisa unutar obrisa drugog elementa, koji su ondje rupe: { $count }
    .hint = { $union } zadržava što bilo koji element boji, { $parity } kaže da se misli na rupe
shape-thin_triangles-ThinTriangles = { $count } od trokuta, kojih je { $triangles }, ima kutove ispod { $least }°, najmanji od { $angle }° u ({ $x }, { $y }): { $cause }
    .allowed = kutovi od { $least }° naviše
shape-no_area-LeftOut = izostavljeno obrisa bez površine: { $count }
shape-dropped-Dropped = { $count } od { $outlines } obrisa manje je od { $least } m² i izostavljeno
shape-overlap-Union = obrisa koji se sijeku, prekrivaju ili dodiruju: { $count }; { $overlap } zadržava što pokriva bilo koji, ostaje obrisa: { $left }
shape-overlap-EvenOdd = obrisa koji se sijeku, prekrivaju ili dodiruju: { $count }; { $overlap } zadržava što obuhvaća neparan broj njih, ostaje obrisa: { $left }

## FaceProblem

mesh-degenerate_face-Few = strana ima manje od tri ugla
    .allowed = barem tri različita ugla strane koja je gotovo ravna i ne siječe samu sebe
mesh-degenerate_face-Twice = strana imenuje vrh dvaput
    .allowed = barem tri različita ugla strane koja je gotovo ravna i ne siječe samu sebe
mesh-degenerate_face-Crossing = strana siječe ili dodiruje samu sebe, ili ništa ne okružuje
    .allowed = barem tri različita ugla strane koja je gotovo ravna i ne siječe samu sebe
mesh-degenerate_face-Bent = strana je daleko od ravne: jedan joj ugao leži { $off } njezine veličine izvan njezine ravnine
    .allowed = barem tri različita ugla strane koja je gotovo ravna i ne siječe samu sebe

## SurfaceError

mesh-empty-NoTriangles = datoteka nema trokuta
    .allowed = barem jedan trokut
mesh-index-Index = { $problem }
scene-range-Weld = { $problem }
scene-missing-Filling = { $problem }
mesh-duplicate_element-SameCorners = trokuti { $first } i { $second } imaju iste uglove
    .hint = izostavi jedan od njih
mesh-degenerate_face-NoArea = trokut { $triangle } nema površine za svoju veličinu
    .allowed = površina iznad { $least } kvadrata najduljeg brida
mesh-degenerate_face-Joined = trokut { $triangle } imenuje isto mjesto dvaput kad se spoje vrhovi bliži od { $distance } m
    .hint = uzmi manji { $weld } ili izostavi trokut
mesh-degenerate_face-VertexTwice = trokut { $triangle } imenuje vrh dvaput
    .allowed = tri različita vrha
mesh-degenerate_face-Face = { $problem } (strana { $face })
    .allowed = barem tri različita ugla strane koja je gotovo ravna i ne siječe samu sebe
mesh-degenerate_face-Element = { $problem } (element { $element })
    .allowed = barem tri različita ugla strane koja je gotovo ravna i ne siječe samu sebe
mesh-index-NoVertexOfTriangle = trokut { $triangle } imenuje vrh { $vertex }
    .allowed = ispod { $count }
mesh-open-NothingToFill = otvorena ploha nema unutrašnjosti koja bi se ispunila
    .hint = zatvori je s { $cap }
mesh-open-NotRemeshed = otvorena ploha ne može dobiti novu mrežu
    .allowed = zatvorena ploha
    .hint = zatvori je s { $cap }
mesh-open-Open = ploha nije zatvorena: slobodnih rubova: { $loops }, kroz { $positions }
    .allowed = zatvorena ploha
mesh-dimension-Flat = zatvorena ploha je ravna: ne obuhvaća obujam
    .allowed = obujam iznad 1e-12 kuba njezine veličine
mesh-non_manifold-Pinched = dijelovi plohe vise o jednom vrhu: { $positions }
    .allowed = trokuti koji svaki vrh obilaze jednom
    .hint = razmakni dijelove ili svakome daj vlastiti vrh
mesh-non_manifold-CrowdedEdges = više od dva trokuta susreću se na bridovima, kojih je { $count }: { $positions }
    .allowed = najviše dva
mesh-non_orientable-OneSided = ploha ima samo jednu stranu, kao Möbiusova vrpca
mesh-self_intersection-MeetsItself = ploha susreće samu sebe: trokut { $first } oko ({ $first_center }) siječe, dodiruje ili prekriva trokut { $second } oko ({ $second_center })
    .allowed = trokuti koji se susreću samo u zajedničkim vrhovima i bridovima
    .hint = { $keep } uzima plohu kakva jest
mesh-size-Extent = ploha nema veličine ili je ona izvan raspona
    .allowed = veličina od 1e-150 do 1e150
scene-not_finite-NotFiniteVertex = koordinata vrha { $vertex } je { $value }
    .allowed = konačan broj
scene-not_finite-NotFiniteCoordinate = koordinata je { $value }
    .allowed = konačan broj

## SurfaceNotice

mesh-concave_face-Concave = udubljenih strana: { $count } od onih s više od tri ugla, kojih je { $faces }; razrezane su po dijagonalama iznutra
mesh-bent_face-BentFaces = strana koje nisu ravne: { $count } od onih s više od tri ugla, kojih je { $faces }, do { $off } svoje veličine; razrezane su po boljim dijagonalama
mesh-sliver-Slivers = { $count } od { $triangles } trokuta tanki su kao iver; najtanji je trokut { $thinnest }, s površinom od { $area } kvadrata najduljeg brida
    .allowed = površine od { $least } naviše
    .hint = { $remesh } čini gotovo jednakostranične trokute
mesh-unreferenced-UnreferencedVertices = izostavljeno vrhova koje nijedan trokut ne imenuje: { $count }
mesh-scale-Scale = ploha je velika { $extent } m
    .allowed = { $least } m do { $most } m, gdje { $size } nije zadan
mesh-welded-Welded = { $count } od { $vertices } vrhova { $count ->
        [one] spojen
       *[other] spojeno
    } je s drugima
mesh-capped-Capped = slobodnih rubova zatvorenih lepezama trokuta: { $count }
mesh-flipped-Against = okrenuto trokuta suprotnih svojim susjedima: { $count }
mesh-flipped-InsideOut = okrenuto izvrnutih dijelova: { $count }
mesh-not_compared-NotCompared = previše trokuta leži jedan preko drugog: nisu svi uspoređeni, i neki se možda sijeku
mesh-self_intersection-Crossings = parova trokuta koji se sijeku, dodiruju ili prekrivaju: { $count }
mesh-self_intersection-ManyCrossings = parova trokuta koji se sijeku, dodiruju ili prekrivaju, ili više: { $count }
mesh-strokes-Strokes = izostavljeno linija i točaka: { $count }

## ObjError

obj-syntax-FewCoordinates = vrh ima manje od tri koordinate
    .allowed = v x y z, tri koordinate
obj-syntax-ManyNumbers = vrh ima više od sedam brojeva
    .allowed = v x y z, s težinom ili bojom
obj-syntax-FiveNumbers = vrh ima pet brojeva
    .allowed = 3 broja, 4 s težinom, 6 s bojom, 7 s oboje
obj-syntax-Corner = ugao strane nije cijeli broj
    .allowed = v, v/vt, v//vn ili v/vt/vn
mesh-index-Zero = brojevi vrhova počinju od 1
    .allowed = 1 do { $count }, ili -{ $count } do -1
mesh-index-BeforeFirst = broj je ispred prvog vrha
    .allowed = 1 do { $count }, ili -{ $count } do -1
obj-syntax-Statement = naredba `{ $word }` ovdje se ne čita
    .allowed = v, vt, vn, vp, f, l, p, o, g, s, usemtl, mtllib, # napomene
mesh-index-NoExtras = strana imenuje `{ $what }` kojeg nema
    .allowed = bez `{ $what }`: datoteka ga nema
mesh-index-NoExtra = strana imenuje `{ $what }` kojeg nema
    .allowed = 1 do { $count }, ili -{ $count } do -1
mesh-index-NoVertexOfFile = nema vrha { $vertex }
    .allowed = 1 do { $count }
scene-not_finite-NotFiniteNumberOfVertex = koordinata nije konačna
    .allowed = konačan broj
shape-number-NoNumber = ovo nije broj
    .allowed = broj, kao 1.5 ili -2e-3

## ObjNotice

obj-weight-Weights = vrhova s težinom različitom od 1, kakvu trokuti nemaju: { $count }

## PlyError

ply-size-Promised = zaglavlje najavljuje { $count } od `{ $element }`, a slijedi samo { $rest } bajtova
    .allowed = najviše { $most }
    .hint = datoteka je odrezana
ply-syntax-NoCoordinates = `vertex` nema svojstva x, y, z
ply-syntax-NoIndices = `face` nema popis vertex_indices
ply-syntax-NoElement = elementa `{ $element }` nema prije njegove uporabe
mesh-index-NoVertexOfFace = strana { $face } imenuje vrh { $vertex }
    .allowed = 0 do { $most }
ply-size-Behind = iza zadnjeg elementa slijedi { $count } bajtova
    .allowed = 0 bajtova
ply-syntax-NoEnd = zaglavlje nema kraja
    .allowed = end_header
ply-syntax-NoMagic = datoteka ne počinje s `ply`
    .allowed = ply
ply-syntax-Format = zapis je nepoznat
    .allowed = ascii, binary_little_endian ili binary_big_endian
ply-syntax-Count = količina nije cijeli broj
    .allowed = 0 ili više
ply-syntax-ListProperty = svojstvo se ne može pročitati
    .allowed = property list VRSTA VRSTA ime, ispod elementa
ply-syntax-ListCount = količina u popisu nije cijeli broj
    .allowed = cjelobrojna vrsta
ply-syntax-Property = svojstvo se ne može pročitati
    .allowed = property VRSTA ime, ispod elementa
ply-syntax-Line = ovaj redak ne može se pročitati
    .allowed = format, comment, element, property ili end_header
ply-syntax-LongHeader = zaglavlje je predugo
    .allowed = najviše 1000 elemenata i 10000 svojstava
ply-syntax-NoFormat = zaglavlje ne imenuje zapis
    .allowed = format ascii 1.0, na primjer
ply-size-ListLength = popis `{ $property }` ima { $length } vrijednosti
    .allowed = 0 do { $most }, koliko datoteka može sadržavati
ply-size-Ends = datoteka završava usred elementa
    .hint = datoteka je odrezana
ply-size-TextEnds = datoteka završava usred elementa
shape-number-NoDecimalNumber = `{ $word }` nije broj
    .allowed = broj s decimalnom točkom
shape-number-NotWhole = `{ $word }` nije broj
    .allowed = cijeli broj

## PlyNotice

ply-element-Element = { $count } od `{ $element }` izostavljeno

## StlError

stl-size-Promised = u bajtu 80 zaglavlje najavljuje { $triangles } trokuta, a datoteka ima { $length } bajtova
    .allowed = { $promised } bajtova
    .hint = datoteka je odrezana ili nije STL
stl-size-Short = datoteka ima { $length } bajtova
    .allowed = 84 bajta i po 50 za svaki trokut, ili tekst koji počinje sa `solid`
stl-syntax-Coordinates = vrh ima { $count } koordinata
    .allowed = vertex x y z, tri koordinate
stl-syntax-NoFacet = `{ $line }` ne pripada ovamo
    .allowed = facet normal … ili endsolid
stl-syntax-Other = `{ $line }` ne pripada ovamo
    .allowed = { $wanted }
stl-syntax-Ends = datoteka završava u sredini
    .allowed = { $wanted }

## StlNotice

stl-normal-Broken = normala koje nisu brojevi, pa stranu kaže redoslijed uglova: { $count }
stl-normal-Against = normala okrenutih protiv svojih trokuta, pa stranu kaže redoslijed uglova: { $count }

## Sized

part-gltf_size-File = u bajtu 8 duljina datoteke
part-gltf_size-Chunk = odsječak počinje u bajtu

## GltfError

gltf-size-CutOff = { $what }: { $length }, a datoteka ima { $bytes } bajtova
    .hint = datoteka je odrezana
gltf-size-Behind = { $what }: { $length }, a datoteka ima { $bytes } bajtova
    .hint = duljina obuhvaća cijelu datoteku: izostavi što slijedi, bajtova: { $more }
gltf-size-Chunk = u bajtu { $byte } duljina odsječka: { $length }, a datoteka ima { $bytes } bajtova
    .hint = datoteka je odrezana
gltf-version-BinaryVersion = u bajtu 4 inačica { $version }
    .allowed = 2
gltf-size-NoJson = datoteka nema odsječak JSON
    .allowed = odsječak `JSON` u bajtu 12
gltf-version-Version = inačica `{ $version }` ne može se pročitati
    .allowed = 2.0
gltf-unsupported-Extension = datoteka treba `{ $extension }`
    .allowed = bez sažimanja i bez drugih obaveznih proširenja
    .hint = izvezi bez sažimanja
gltf-syntax-NoScene = datoteka ne imenuje scenu
    .allowed = `scenes` s `nodes`
gltf-index-NoEntry = nema `{ $what }` { $index }
    .allowed = ispod { $count }
gltf-tree-Parents = čvor { $node } ima dva roditelja ili je sam svoj
    .allowed = po jedan roditelj za svaki čvor
    .hint = daj svakom mjestu vlastiti čvor koji imenuje istu mrežu
gltf-depth-Depth = čvorovi (nodes) ugniježđeni su dublje od { $deepest } ili sadrže sami sebe
    .allowed = najviše { $deepest } razina
gltf-unsupported-Mode = primitive načina { $mode } ne mogu se pročitati
    .allowed = 4 (trokuti)
gltf-syntax-NoPosition = primitiva nema POSITION
    .allowed = atribut POSITION
scene-not_finite-NotFinitePosition = koordinata vrha { $vertex } nije konačna
    .allowed = konačni brojevi
gltf-syntax-Corners = primitiva ima uglova: { $corners }
    .allowed = po tri za svaki trokut
gltf-unsupported-Sparse = rijetki accessor ne može se pročitati
gltf-syntax-Accessor = accessor sadrži { $kind } vrste { $component }
    .allowed = { $wanted } vrste { $components }
gltf-unsupported-NoView = accessor nema bufferView
gltf-size-Rows = redaka: { $rows }, po { $each } bajtova, ne leže u pogledu i njegovu spremniku od { $bytes } bajtova
    .hint = datoteka je odrezana ili je pogled (view) prekratak
gltf-syntax-NoBytes = spremnik nema ni adresu ni binarni odsječak
gltf-syntax-Base64 = adresa s podacima nije base64
    .allowed = data:…;base64,…
gltf-size-Buffer = spremnik najavljuje { $promised } bajtova, a ima ih { $bytes }
    .allowed = { $promised } bajtova

## GltfNotice

gltf-scenes-Scenes = izostavljeno drugih scena: { $count }
gltf-skin-Skins = izostavljeno koža, po kojima vrhovi prate kosti: { $count }
gltf-morph-Morphs = dijelova čiji su oblici za pretapanje izostavljeni: { $count }
gltf-animation-Animations = izostavljeno animacija: { $count }

## SvgError

svg-unknown_id-UnknownId = nijedan element nema id `{ $id }`
svg-same_id-SameId = dva elementa imaju id `{ $id }`
    .allowed = različiti id
svg-unsupported-Stretched = crtež je u jednom smjeru rastegnut više nego u drugom
    .allowed = širina i visina u omjeru kao u `viewBox`
svg-unsupported-Language = ne zna se na koji se jezik misli
    .hint = ostavi jedan element u <switch>
svg-unsupported-Property = `{ $property }` se ne može pročitati
    .hint = primijeni to u programu za crtanje
svg-depth-Depth = elementi su ugniježđeni dublje od { $deepest }
    .allowed = najviše { $deepest } razina
svg-unsupported-NoOutline = <{ $element }> ovdje nema obrisa
    .hint = pretvori tekst u krivulje u programu za crtanje, ili u prizoru uzmi oblik s `kind = "text"`
svg-unsupported-Element = <{ $element }> se ne može pročitati
    .allowed = path, rect, circle, ellipse, polygon, polyline unutar svg, g, a, switch, use
svg-outside-Outside = `{ $link }` nije element ove datoteke
    .allowed = href = "#id" iz ove datoteke
    .hint = druge se datoteke nikad ne čitaju
svg-cycle-Cycle = `#{ $id }` sadrži sam sebe
    .hint = element se ne može crtati unutar samog sebe
svg-unsupported-SizeOfUse = <use> ne može <svg>-u dati drugu veličinu
    .hint = zadaj `width` i `height` u samom <svg>
svg-unsupported-SizeOfView = ne zna se koliko se veliko `viewBox` crta
    .hint = zadaj njegovu elementu `width` i `height`
svg-unsupported-Framed = <{ $element }> ima okvir koji odrezuje { $percent } % onoga što je u njemu
    .allowed = sadržaj unutar okvira
    .hint = `overflow="visible"` pokazuje sve
svg-unsupported-Clipped = `clip-path` odrezuje { $percent } % nacrtanog
    .allowed = putanje rezanja oko svega nacrtanog
    .hint = primijeni to u programu za crtanje
svg-syntax-Attribute = `{ $attribute }` se ne može pročitati: „{ $reason }”
svg-syntax-ViewBox = `viewBox` se ne može pročitati: „{ $reason }”
    .allowed = x y širina visina
svg-number-Transform = transform izlazi iz raspona brojeva
svg-unsupported-Length = `{ $attribute }` nije duljina koja se može pročitati
    .allowed = konačan broj bez jedinice, ili u px, pt, pc, mm, cm, in, ili u % crteža s `viewBox`
svg-number-Negative = `{ $attribute }` je negativno
    .allowed = 0 ili više
svg-syntax-OddPoints = `points` ima { $count } brojeva, što je neparno
    .allowed = parovi brojeva
svg-number-Path = krivulja izlazi iz raspona brojeva
svg-unsupported-FillRule = ovo nije `fill-rule`
    .allowed = evenodd ili nonzero
svg-colour-Share = `{ $property }` nije broj
    .allowed = 0 do 1
svg-colour-Colour = ispuna nije boja kojom se može bojiti
    .allowed = boja, kao #ffac33 ili gold, prijelaz iz ove datoteke, none
    .hint = { $colours } čita samo obris
svg-style-Style = stilski list ovdje možda zadaje `{ $property }`, što mijenja obrise
    .allowed = pravila bez uvjeta, iza imena, `.razreda` i `#id`
    .hint = neka program za crtanje piše atribute umjesto lista
svg-syntax-NoDrawing = datoteka nije crtež nego <{ $element }>
    .allowed = <svg>
svg-syntax-Xml = ovo nije ispravan XML: „{ $reason }”
limit-elements-Elements = ovo nije ispravan XML: „{ $reason }”
svg-entity-OutsideEntity = ovo nije ispravan XML: „{ $reason }”
    .hint = entiteti izvan datoteke nikad se ne čitaju
svg-entity-EntityLoop = ovo nije ispravan XML: „{ $reason }”
    .hint = entiteti ne smiju sadržavati jedan drugi

## SvgNotice

svg-open_path-OpenPaths = otvorenih krivulja zatvorenih dužinom: { $count }
svg-stroke-Unfilled = oblika bez ispune, čitanih po obrisu umjesto po potezu: { $count }
svg-empty-Empty = izostavljeno likova bez putanje ili točaka: { $count }
svg-image-Images = izostavljeno slika: { $count }
svg-hidden-Hidden = izostavljeno nevidljivih elemenata: { $count }
svg-marker-Markers = elemenata čije su oznake izostavljene: { $count }
svg-filter-Filters = elemenata čiji filtar nije primijenjen: { $count }
svg-stroke-Strokes = popunjenih oblika čiji je potez izostavljen, pa obris ide njegovom sredinom: { $count }
svg-animation-Animations = izostavljeno animacija: { $count }
svg-gradient-Gradients = prijelaza obojenih srednjom bojom: { $count }
svg-style-Styled = likova za koje stilski list možda ima pravilo, iza selektora koji se ne čita, pa boje mogu biti druge: { $count }
svg-fill_rule-FillRule = oblika bez `fill-rule`, koji bi po pravilu nonzero imali manje rupa: { $count }
    .hint = `fill-rule="evenodd"` ili `fill-rule="nonzero"` u datoteci kaže na što se misli

## MapError

map-unknown_layer-NoLayers = nema sloja `{ $layer }`
    .allowed = bez { $setting }: slojeve ima samo topologija
map-unknown_layer-NoLayer = nema sloja `{ $layer }`
    .allowed = { $known }
map-unknown_layer-SeveralLayers = karta ima slojeva: { $count }
    .allowed = { $known }
    .hint = imenuj jedan s { $setting }
map-syntax-Position = položaj ima brojeva: { $count }
    .allowed = dva ili tri broja
map-depth-Depth = zbirke su ugniježđene dublje od { $deepest }
    .allowed = najviše { $deepest } razina
map-syntax-Kind = `{ $kind }` nije vrsta koja se ovdje čita
    .allowed = FeatureCollection, Feature, GeometryCollection, Polygon, MultiPolygon i Topology
map-syntax-NoField = { $kind } nema `{ $field }`
    .allowed = { $field }
map-arc-NoArc = nema luka { $arc }
    .allowed = { $least } do { $most }
map-syntax-OpenRing = prsten nije zatvoren
    .allowed = četiri položaja ili više, zadnji kao prvi
map-hole-Hole = rupa { $hole } leži izvan svojeg poligona
    .allowed = rupe unutar prvog prstena poligona
    .hint = otoci su zasebni poligoni
map-unknown_feature-Nothing = `{ $feature }` nije ništa
    .allowed = obilježja s poligonima
map-unknown_feature-NoGeometry = `{ $feature }` je obilježje bez geometrije
    .allowed = obilježja s poligonima
map-unknown_feature-PointsAndLines = `{ $feature }` su samo točke i linije
    .allowed = obilježja s poligonima
map-unknown_feature-NoFeature = nijedan poligon ne pripada `{ $feature }`
    .allowed = `id` obilježja ili tekst među njegovim svojstvima
shape-no_area-NoPolygon = karta nema poligona
map-range-Range = ({ $x }, { $y }) nije mjesto na globusu
    .allowed = zemljopisne širine od -{ $most } do { $most }, dužine od -540 do 540
    .hint = { $projection } uzima koordinate kakve jesu
json-syntax-Json = ovo nije ispravan JSON: „{ $reason }”

## MapNotice

mesh-strokes-PointsAndLines = izostavljeno točaka i linija: { $count }
map-empty-Empty = obilježja bez geometrije: { $count }
map-antimeridian-Over = obrisa preko antimeridijana, u jednom komadu: { $count }
map-antimeridian-Cut = poligona rezanih duž antimeridijana, opet spojenih: { $count }
map-antimeridian-Beside = poligona pomaknutih za 360° uz druge: { $count }
map-pole-Polar = obrisa oko pola, rezanih duž antimeridijana i zatvorenih duž pola: { $count }
map-features-Features = { $count } obilježja pripada `{ $feature }` i čita se zajedno

## LetterError

font-syntax-Font = ovo nije font koji se može pročitati: „{ $reason }”
    .allowed = OpenType ili TrueType (.ttf, .otf)
font-no_glyph-NoLetter = `{ $letter }` nije slovo
font-script-Script = `{ $letter }` je iz pisma čija se slova ne slažu jedno po jedno slijeva nadesno
    .allowed = slova, kao latinična, grčka ili ćirilična, bez zasebnih znakova nad njima
    .hint = nacrtaj tekst u programu za crtanje i pretvori ga u krivulje SVG-datoteke
font-no_glyph-NoGlyph = font `{ $font }` nema slovo `{ $letter }`
shape-no_area-EmptyText = tekst je prazan
    .allowed = barem jedno slovo koje se crta
shape-no_area-NoLetters = tekst nema slova s obrisom
    .allowed = barem jedno slovo koje se crta
shape-no_area-NoPixel = nijedan piksel nije više { $inside } od praga
    .allowed = pikseli iznad { $threshold }
    .hint = uzmi manji { $lower } ili drugi { $choice }: dark, bright ili opaque
png-syntax-Png = ovo nije PNG koji se može pročitati: „{ $reason }”
    .allowed = slika u PNG
