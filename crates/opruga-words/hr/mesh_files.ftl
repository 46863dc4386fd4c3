# What readers of mesh files say.

## ElementName

part-element-Point = točka
part-element-Line = crta
part-element-QuadraticLine = kvadratna crta
part-element-Edge = brid
part-element-Triangle = trokut
part-element-Quadrilateral = četverokut
part-element-QuadraticTriangle = kvadratni trokut
part-element-Tetrahedron = tetraedar
part-element-Hexahedron = heksaedar
part-element-QuadraticTetrahedron = kvadratni tetraedar
part-element-Prism = prizma
part-element-Pyramid = piramida
part-element-Wedge = klin
part-element-QuadraticQuadrilateral = kvadratni četverokut
part-element-QuadraticHexahedron = kvadratni heksaedar
part-element-QuadraticPrism = kvadratna prizma
part-element-QuadraticWedge = kvadratni klin
part-element-QuadraticPyramid = kvadratna piramida
part-element-SerendipityQuadrilateral = četverokut bez unutrašnjih čvorova
part-element-SerendipityHexahedron = heksaedar bez unutrašnjih čvorova
part-element-SerendipityPrism = prizma bez unutrašnjih čvorova
part-element-SerendipityPyramid = piramida bez unutrašnjih čvorova
part-element-IncompleteTriangle = nepotpuni trokut višeg reda
part-element-CubicTriangle = kubni trokut
part-element-Triangle4 = trokut reda 4
part-element-Triangle5 = trokut reda 5
part-element-CubicLine = kubna crta
part-element-Line4 = crta reda 4
part-element-Line5 = crta reda 5
part-element-CubicTetrahedron = kubni tetraedar
part-element-Tetrahedron4 = tetraedar reda 4
part-element-Tetrahedron5 = tetraedar reda 5
part-element-CubicHexahedron = kubni heksaedar
part-element-UnknownType = element nepoznate vrste
part-element-UnknownGeometry = element nepoznate geometrije
part-element-Points = skup točaka
part-element-Lines = lanac crta
part-element-Strip = traka trokuta
part-element-Polygon = poligon
part-element-Polyhedron = poliedar
part-element-HigherCell = ćelija višeg reda
part-element-UnknownCell = ćelija nepoznate vrste

## Expected

part-expected-Nothing = {""}
part-expected-Dimension = dimenzija
part-expected-Group = skupina
part-expected-Names = imena
part-expected-Texts = tekstovi
part-expected-RealTags = realne oznake
part-expected-RealTag = realna oznaka
part-expected-WholeTags = cjelobrojne oznake
part-expected-WholeTag = cjelobrojna oznaka
part-expected-Tags = oznake
part-expected-Tag = oznaka
part-expected-Values = vrijednosti
part-expected-Value = vrijednost
part-expected-Nodes = čvorovi
part-expected-Node = čvor
part-expected-Coordinate = koordinata
part-expected-Coordinates = koordinate
part-expected-ParametricCoordinate = parametarska koordinata
part-expected-Elements = elementi
part-expected-Element = element
part-expected-NodeOfElement = čvor elementa
part-expected-VertexOfElement = vrh elementa
part-expected-Blocks = blokovi
part-expected-BlockOfNodes = blok čvorova
part-expected-BlockOfElements = blok elemenata
part-expected-Entities = entiteti
part-expected-Entity = entitet
part-expected-CoordinateOfEntity = koordinata entiteta
part-expected-PhysicalGroups = fizičke skupine
part-expected-PhysicalGroup = fizička skupina
part-expected-BoundingEntities = granični entiteti
part-expected-BoundingEntity = granični entitet
part-expected-Vertices = vrhovi
part-expected-Vertex = vrh
part-expected-Lines = reci
part-expected-Number = broj
part-expected-Count = količina
part-expected-Section = odjeljak
part-expected-Attribute = atribut
part-expected-Marker = oznaka
part-expected-Head = zaglavlje
part-expected-HeadOfArray = zaglavlje polja
part-expected-Offsets = pomaci
part-expected-Arrays = polja
part-expected-NodesOfCells = čvorovi ćelija
part-expected-TypesOfCells = vrste ćelija
part-expected-NumberType = vrsta brojeva
part-expected-Version = inačica
part-expected-Format = zapis
part-expected-FileKind = vrsta datoteke, 0 ili 1
part-expected-AsciiOrBinary = ASCII ili BINARY
part-expected-ZeroOrOne = 0 ili 1
part-expected-End = `End`
part-expected-DataSet = vrsta skupa podataka
part-expected-SizeOfNumbers = veličina brojeva
part-expected-SizeOfCells = veličina popisa ćelija
part-expected-DimensionOfEntity = dimenzija entiteta
part-expected-TheDimension = dimenzija
part-expected-TypeOfElement = vrsta elementa
part-expected-TypeOfElements = vrsta elemenata
part-expected-GeometryOfElement = geometrija elementa
part-expected-ReferenceOfVertex = oznaka vrha
part-expected-ReferenceOfElement = oznaka elementa
part-expected-CountOfValues = broj vrijednosti
part-expected-One = broj 1
part-expected-NumberOfNames = broj imena
part-expected-NumberOfGroup = broj skupine
part-expected-NumberOfTexts = broj tekstova
part-expected-NumberOfRealTags = broj realnih oznaka
part-expected-NumberOfWholeTags = broj cjelobrojnih oznaka
part-expected-NumberOfTags = broj oznaka
part-expected-NumberOfElement = broj elementa
part-expected-NumberOfElementsOfBlock = broj elemenata bloka
part-expected-NumberOfElements = broj elemenata
part-expected-NumberOfNodesOfElement = broj čvorova elementa
part-expected-NumberOfNodes = broj čvorova
part-expected-NumberOfNode = broj čvora
part-expected-LowestNode = najmanji broj čvora
part-expected-HighestNode = najveći broj čvora
part-expected-LowestElement = najmanji broj elementa
part-expected-HighestElement = najveći broj elementa
part-expected-NumberOfEntity = broj entiteta
part-expected-NumberOfEntities = broj entiteta
part-expected-NumberOfPhysicalGroups = broj fizičkih skupina
part-expected-NumberOfBoundingEntities = broj graničnih entiteta
part-expected-NumberOfBlocks = broj blokova
part-expected-NumberOfVertices = broj vrhova
part-expected-NumberOfVertex = broj vrha
part-expected-NumberOfCoordinates = broj koordinata
part-expected-NumberOfAttributes = broj atributa
part-expected-NumberOfMarkers = broj oznaka
part-expected-NumberOfPoints = broj točaka
part-expected-NumberOfCells = broj ćelija
part-expected-NumberOfArrays = broj polja
part-expected-NumberOfComponents = broj komponenata
part-expected-NumberOfValues = broj vrijednosti
part-expected-NumberOfColours = broj boja
part-expected-NameOfField = ime polja
part-expected-NameOfArray = ime polja
part-expected-NameOfValues = ime vrijednosti
part-expected-NameOfTable = ime tablice

## NumberHint

part-number_hint-Comma = napiši točku, ne zarez

## CornerOrder

part-corner_order-Plane = pozitivna površina: uglovi u smjeru suprotnom od kazaljke na satu
part-corner_order-Space = pozitivan obujam: zadnji ugao na strani s koje ostali idu suprotno od kazaljke na satu

## NumberRange

part-number_range-Real = broj, kao 1.5 ili -2e-3
part-number_range-Between = broj >= { $least } i <= { $most }
part-number_range-Whole = cijeli broj od { $least } do { $most }

## Listed

part-listed-Nodes = jedan od čvorova, njih { $count }, od { $first } do { $last }
part-listed-NoNodes = datoteka nema čvorova
part-listed-NoEntities = $Entities ne navodi nijedan od { $dimension } dimenzija
part-listed-Entity = { $entity }
part-listed-Entities = jedan od navedenih, njih { $count }, od { $first } do { $last }

## Keyword

part-keyword-One = `{ $word }`
part-keyword-Two = `{ $first }` i `{ $second }`

## ScanError

part-scan-Ends = datoteka završava, a slijediti treba: { $wanted }
    .hint = datoteka je odrezana
part-scan-CutLine = datoteka završava usred zadnjeg retka, možda usred broja
    .allowed = prijelom retka iza zadnje riječi
    .hint = zadnji redak treba završiti prijelomom retka ako je datoteka cijela; inače je odrezana
part-scan-Behind = iza ovoga stoji još nešto: { $of }
    .allowed = kraj retka
part-scan-Other = `{ $word }` stoji umjesto ovoga: `{ $wanted }`
    .allowed = { $wanted }
part-scan-NotWhole = `{ $word }` stoji umjesto ovoga: { $what }
    .allowed = cijeli broj
part-scan-NotNumber = `{ $word }` stoji umjesto ovoga: { $what }
    .allowed = { $allowed }
    .hint = { $hint }
scene-not_finite-NotFiniteNumber = broj nije konačan ({ $what })
    .allowed = konačan broj
part-scan-Promised = najavljeno: { $count } ({ $what }), a slijedi samo bajtova: { $rest }
    .allowed = najviše { $most }
    .hint = datoteka je odrezana
part-scan-SecondSection = odjeljak `{ $section }` stoji dvaput
    .allowed = jedan
part-scan-NumberType = `{ $word }` nije vrsta brojeva
    .allowed = { $allowed }
part-scan-PointValuesTwice = točke imaju vrijednosti `{ $name }` dvaput
    .allowed = svakom polju njegovo ime
part-scan-CellValuesTwice = ćelije imaju vrijednosti `{ $name }` dvaput
    .allowed = svakom polju njegovo ime

## MeshFileError

mesh-empty-Empty = datoteka je prazna
    .allowed = mreža
mesh-format-NeitherMfemNorMedit = datoteka nije mreža programa MFEM ni Medit
    .allowed = `MFEM mesh v1.0` ili `MeshVersionFormatted 2` na njezinu početku
mesh-unsupported_element-UnsupportedType = element ove vrste ne može se pročitati: { $element } (vrsta { $number })
    .allowed = točke, crte od 2 ili 3 čvora, trokuti od 3 ili 6, četverokuti od 4, tetraedri od 4 ili 10, heksaedri od 8
mesh-unsupported_element-UnsupportedGeometry = element ove vrste ne može se pročitati: { $element } (geometrija { $number })
    .allowed = točke, crte od 2 ili 3 čvora, trokuti od 3 ili 6, četverokuti od 4, tetraedri od 4 ili 10, heksaedri od 8
mesh-unsupported_element-UnsupportedCell = ćelija { $cell } ne može se pročitati: { $element } (vrsta { $number })
    .allowed = točke, crte od 2 ili 3 čvora, trokuti od 3 ili 6, četverokuti od 4, tetraedri od 4 ili 10, heksaedri od 8
mesh-duplicate_element-ElementTwice = dva elementa imaju broj { $number }
    .allowed = svakom elementu njegov broj
mesh-duplicate_node-NodeTwice = dva čvora imaju broj { $number }
    .allowed = svakom čvoru njegov broj
mesh-components-Components = čvorovi imaju brojeva: { $before }, pod imenom `{ $name }`, a drugi { $components }
    .allowed = { $before }
mesh-index-NoNode = element { $element } imenuje čvor { $node }, kojeg nema
    .allowed = { $listed }
mesh-index-NoNodeOfValue = vrijednost imenuje čvor { $node }, kojeg nema
    .allowed = { $listed }
mesh-index-NoVertex = { $element } { $index } imenuje vrh { $vertex }
    .allowed = { $least } do { $most }
mesh-empty-NoElements = datoteka nema elemenata
    .allowed = barem jedan element
mesh-dimension-PointsOnly = datoteka ima samo točke
    .allowed = crte, trokuti, četverokuti, tetraedri ili heksaedri
mesh-dimension-SurfaceInSpace = datoteka ima plohu u prostoru, a ništa što je ispunjava
    .allowed = tetraedri ili heksaedri
    .hint = `kind = "surface"` čita plohe; s `filling = "tetrahedra"` ih ispunjava
mesh-dimension-SpaceInPlane = datoteka ima prostorne elemente, a prizor leži u ravnini
    .allowed = trokuti ili četverokuti
    .hint = `dimension = 3` na početku prizora
mesh-dimension-OutOfPlane = čvor { $node } leži izvan ravnine prvog čvora
    .allowed = z = { $plane }
    .hint = `dimension = 3` na početku prizora
mesh-dimension-NoSurface = datoteka sadrži ćelije koje ispunjavaju tijelo, a ne samu plohu
    .allowed = trokuti i četverokuti
    .hint = `kind = "mesh"` čita ispunjena tijela
shape-too_large-TooManyNodes = mreža ima { $nodes } čvorova
    .allowed = najviše { $most }
mesh-degenerate_element-RepeatedNode = { $element } { $index } imenuje čvor { $node } dvaput
    .allowed = svaki čvor jednom
mesh-duplicate_element-SameNodes = elementi { $first } i { $second } imaju iste čvorove
    .hint = izostavi jedan od njih
mesh-mixed_dimension-NoPartOfCell = { $element } { $index } nije dio nijedne ćelije
    .allowed = strane, bridovi i uglovi ćelija, ili tijelo od jedne dimenzije
mesh-degenerate_element-NoArea = { $element } { $index } nema površine za svoju veličinu
    .allowed = više od { $least } kvadrata najduljeg brida
mesh-degenerate_element-NoVolume = { $element } { $index } nema obujma za svoju veličinu
    .allowed = više od { $least } kuba najduljeg brida
mesh-inverted-Folded = { $element } { $index } preklopljen je preko sebe{ $count ->
        [1] {""}
       *[other] {" "}(preklopljeno: { $count } od { $cells })
    }
    .allowed = { $order }
mesh-inverted-Inverted = { $element } { $index } je izvrnut{ $count ->
        [1] {""}
       *[other] {" "}(izvrnuto: { $count } od { $cells })
    }
    .allowed = { $order }
    .hint = { $turn } okreće takve ćelije i broji ih
mesh-inverted-AllInverted = { $element } { $index } je izvrnut{ $cells ->
        [1] {""}
       *[other] {" "}(izvrnuto: { $cells } od { $cells })
    }
    .allowed = { $order }
    .hint = cijela datoteka ide obrnuto: { $turn } okreće njezine ćelije i broji ih
mesh-topology-Topology = { $problem }
mesh-non_manifold-Crowded = više od dvije ćelije dijele stranu, kroz čvorove { $first } i { $second }
    .allowed = najviše dvije ćelije na strani
mesh-unreferenced-LooseNode = čvor { $first } ne pripada nijednoj ćeliji
    .allowed = čvorovi ćelija
    .hint = { $leave_out } izostavlja takve čvorove i broji ih
mesh-unreferenced-LooseNodes = čvorova bez ćelije: { $count }, prvi je čvor { $first }
    .allowed = čvorovi ćelija
    .hint = { $leave_out } izostavlja takve čvorove i broji ih

## MeshFileNotice

mesh-left_out-Section = odjeljak ${ $section } je izostavljen
mesh-left_out-Components = vrijednosti s više komponenata (njih { $components }) izostavljene su: `{ $name }`
mesh-left_out-LaterSteps = izostavljeno kasnijih koraka: { $count }, od vrijednosti `{ $name }`
mesh-left_out-Attributes = izostavljeno atributa svakog čvora: { $count }
mesh-left_out-Values = vrijednosti `{ $name }` su izostavljene
mesh-left_out-Colours = boje `{ $name }` su izostavljene
mesh-left_out-Lines = izostavljeno: { $count } { $section }
mesh-left_out-PlaneOffset = z = { $z } svih čvorova izostavljeno je
mesh-left_out-More = izostavljeno još: { $count }
mesh-flipped-Turned = { $count ->
        [one] okrenuta je { $count } izvrnuta ćelija od { $cells }
        [few] okrenute su { $count } izvrnute ćelije od { $cells }
       *[other] okrenuto je { $count } izvrnutih ćelija od { $cells }
    }
mesh-unreferenced-Unreferenced = { $count ->
        [one] izostavljen je { $count } čvor koji nijedna ćelija ne imenuje
        [few] izostavljena su { $count } čvora koja nijedna ćelija ne imenuje
       *[other] izostavljeno je { $count } čvorova koje nijedna ćelija ne imenuje
    }

## Geometry

part-geometry-Point = 0 (točka)
part-geometry-Line = 1 (crta)
part-geometry-Plane = 2 (trokut) ili 3 (četverokut)
part-geometry-Space = 4 (tetraedar) ili 5 (heksaedar)

## Counts

part-counts-OneToThree = 1, 2 ili 3
part-counts-TwoOrThree = 2 ili 3
part-counts-Three = 3

## GmshError

msh-syntax-BetweenSections = `{ $word }` stoji između odjeljaka
    .allowed = odjeljak, kao $Nodes
msh-syntax-BehindElements = odjeljak ${ $section } dolazi iza elemenata
    .allowed = prije $Elements
msh-syntax-ElementsFirst = elementi dolaze prije čvorova
    .allowed = $Nodes
msh-syntax-SecondSection = odjeljak ${ $section } stoji dvaput
    .allowed = jedan
msh-version-Version = inačica `{ $version }` ne može se pročitati
    .allowed = 2.2 ili 4.1
    .hint = Gmsh piše drugu inačicu s `-format msh41` ili `-format msh22`
msh-syntax-FileKind = { $kind } nije vrsta datoteke
    .allowed = 0 (tekst) ili 1 (binarno)
msh-version-NumberSize = brojevi imaju bajtova: { $size }
    .allowed = 8
msh-endianness-Endianness = { $number } stoji umjesto broja 1
    .allowed = 1, redoslijedom bajtova te datoteke
msh-syntax-GroupDimension = skupina ima dimenzija: { $dimension }
    .allowed = 0 do 3
msh-syntax-GroupQuotes = ime skupine ne stoji u navodnicima
    .allowed = "name"
msh-syntax-GroupTwice = skupina { $group } od { $dimension } dimenzija već ima ime `{ $name }`
    .allowed = svakoj skupini jedne dimenzije jedno ime
msh-syntax-NoEnd = odjeljak ${ $section } nema kraja
    .allowed = $End{ $section }
    .hint = datoteka je odrezana
msh-syntax-FewTags = nedostaju korak, broj komponenata i broj vrijednosti
    .allowed = 3 cjelobrojne oznake ili više
mesh-index-NoElement = vrijednost imenuje element { $element }, kojeg nema
    .allowed = broj elementa
mesh-duplicate_node-NodeValueTwice = vrijednost imenuje čvor { $node } dvaput
    .allowed = svaki čvor jednom
mesh-duplicate_element-ElementValueTwice = vrijednost imenuje element { $element } dvaput
    .allowed = svaki element jednom
msh-size-NegativeBlock = blok ima negativan broj elemenata ili oznaka
    .allowed = 0 ili više
msh-size-BlockSize = blok ima elemenata: { $elements }
    .allowed = 1 do { $most }
msh-syntax-EntityDimension = entitet ima dimenzija: { $dimension }
    .allowed = 0 do 3
msh-syntax-EntityTwice = dva entiteta od { $dimension } dimenzija imaju broj { $entity }
    .allowed = svakom entitetu jedne dimenzije njegov broj
msh-size-Bounds = najavljeni su brojevi ({ $what }) od { $lowest } do { $highest }, a tu su oni od { $low } do { $high }
    .allowed = { $low }, { $high }
    .hint = zaglavlje odjeljka je krivo ili nedostaje ono što navodi
msh-syntax-Parametric = čvorovi su parametarski (1) ili nisu (0), a ne { $parametric }
    .allowed = 0 ili 1
msh-size-Promised = najavljeno je { $promised } ({ $what }), a ima ih { $there }
    .allowed = { $there }
msh-syntax-ElementOfEntity = entitet od { $dimension } dimenzija ima elemente vrste { $element }
    .allowed = { $wanted }
mesh-index-NoEntity = $Entities ne navodi entitet { $entity } od { $dimension } dimenzija
    .allowed = { $listed }

## MeditError

medit-version-Version = inačica `{ $version }` ne može se pročitati
    .allowed = 1 do 4
medit-syntax-Dimension = dimenzija je { $dimension }
    .allowed = 2 ili 3
medit-syntax-VerticesTwice = vrhovi stoje dvaput
    .allowed = Dimension, zatim Vertices jednom
medit-syntax-VerticesFirst = vrhovi dolaze prije dimenzije
    .allowed = Dimension, zatim Vertices jednom
mesh-unsupported_element-Unsupported = { $keyword } se ne može pročitati
    .allowed = Edges, Triangles, Quadrilaterals, Tetrahedra ili Hexahedra
mesh-unsupported_element-Quadratic = { $keyword } se ne može pročitati
    .allowed = Edges, Triangles, Quadrilaterals, Tetrahedra ili Hexahedra
    .hint = trokuti od 6 i tetraedri od 10 čvorova čitaju se iz datoteka Gmsh i VTK
medit-syntax-Keyword = `{ $word }` nije ključna riječ koja se može pročitati
    .allowed = Dimension, Vertices, Triangles, Tetrahedra … ili End
medit-syntax-BeforeVertices = { $section } dolaze prije vrhova
    .allowed = Vertices
medit-syntax-BehindEnd = iza `End` još nešto slijedi
    .allowed = kraj datoteke

## MfemError

mfem-version-Version = inačica `{ $version }` ne može se pročitati
    .allowed = v1.0, v1.2, v1.3
mfem-syntax-BehindEnd = iza `mfem_mesh_end` još nešto slijedi
    .allowed = kraj datoteke
mfem-syntax-Dimension = dimenzija je { $dimension }
    .allowed = 1, 2 ili 3
mfem-syntax-BeforeDimension = `{ $section }` stoji prije `dimension`
    .allowed = dimension
mfem-curved-Curved = zakrivljeni elementi (`nodes`) ne mogu se pročitati
    .allowed = `vertices` s koordinatama
    .hint = spremi mrežu bez `nodes`, ravnih stranica; zakrivljene ćelije drugog reda mogu se čitati iz datoteka Gmsh i VTK
mfem-syntax-Section = `{ $word }` nije odjeljak koji se može pročitati
    .allowed = dimension, elements, boundary ili vertices
mesh-index-NoVertexOfBoundary = element ruba imenuje vrh { $vertex }
    .allowed = 0 do { $most }
mesh-index-NoVertexOfElement = element imenuje vrh { $vertex }
    .allowed = 0 do { $most }
mesh-mixed_dimension-ElementOfSection = `{ $section }` mreže od { $dimension } dimenzija ima elemente vrste { $element }
    .allowed = { $wanted }
mfem-syntax-Coordinates = vrhovi imaju koordinata: { $coordinates }
    .allowed = { $wanted }

## TetgenError

tetgen-syntax-Coordinates = čvorovi imaju koordinata: { $coordinates }
    .allowed = 2 ili 3
tetgen-syntax-Markers = čvorovi imaju oznaka: { $markers }
    .allowed = 0 ili 1
mesh-unsupported_element-Corners = elementi imaju čvorova: { $nodes }
    .allowed = 4 (tetraedri) ili 3 (trokuti)
    .hint = TetGen bez opcije -o2 piše linearne tetraedre
tetgen-syntax-Order = element { $element } stoji umjesto elementa { $wanted }
    .allowed = { $wanted }
tetgen-size-Behind = datoteka se nastavlja iza onoga što zaglavlje najavljuje
    .allowed = koliko je redaka najavljeno

## ArrayName

part-array_name-Named = {" "}`{ $name }`

## Doubled

part-doubled-Tag = <{ $tag }>
part-doubled-Array = polje{ $name } u <{ $tag }>

## VtkError

vtk-size-CellNodes = ćelija { $cell } ({ $element }) ima čvorova: { $nodes }
    .allowed = { $wanted }
mesh-index-NoNodeOfCell = ćelija { $cell } imenuje čvor { $node }
    .allowed = 0 do { $most }
vtk-syntax-Head = datoteka ne počinje kao VTK
    .allowed = # vtk DataFile Version 3.0 na početku
vtk-syntax-FileKind = `{ $word }` nije vrsta datoteke
    .allowed = ASCII ili BINARY
vtk-syntax-DataSet = skup podataka je `{ $word }`
    .allowed = UNSTRUCTURED_GRID
vtk-size-Cells = ćelija ima { $there }, a ne { $count }
    .allowed = { $there }
vtk-size-Points = točaka ima { $there }, a ne { $count }
    .allowed = { $there }
vtk-syntax-Keyword = `{ $word }` nije ključna riječ
    .allowed = POINTS, CELLS, CELL_TYPES, CELL_DATA, POINT_DATA, FIELD, SCALARS …
vtk-size-FirstOffset = prva ćelija počinje u { $offset }
    .allowed = { $wanted }
vtk-size-LastOffset = zadnja ćelija završava u { $offset }
    .allowed = { $wanted }
vtk-size-Reach = ćelija seže od { $start } do { $end }
    .allowed = { $start } do { $most }
vtk-size-Follow = ćelija ima čvorova: { $nodes }, a slijedi ih { $there }
    .allowed = najviše { $there }
vtk-size-BehindCells = iza zadnje ćelije slijedi brojeva: { $numbers }
    .allowed = { $wanted }
vtk-size-Types = vrste su zadane za ćelija: { $count }
    .allowed = { $cells }
vtk-size-ValuesOfCells = vrijednosti: { $values }, a ćelija: { $cells }
    .allowed = { $cells }
vtk-size-ValuesOfPoints = vrijednosti: { $values }, a točaka: { $points }
    .allowed = { $points }
vtk-syntax-Texts = polje tekstova ne može se pročitati
    .allowed = brojevi
vtk-syntax-BeforeData = `{ $word }` stoji prije CELL_DATA i POINT_DATA
    .allowed = CELL_DATA ili POINT_DATA ispred toga
vtk-syntax-Components = `{ $word }` nije broj komponenata
    .allowed = 1 do 4

## VtuError

vtu-syntax-Encoding = datoteka nije tekst u UTF-8
    .hint = odrezana je ili nije VTU
vtu-syntax-Xml = ovo nije ispravan XML: „{ $reason }”
    .hint = datoteka je odrezana ili nije VTU
vtu-syntax-Kind = datoteka sadrži `{ $kind }`
    .allowed = <VTKFile type="UnstructuredGrid">
vtu-compressor-Compressor = podaci sažeti s `{ $name }` ne mogu se pročitati
    .allowed = vtkZLibDataCompressor ili ništa
    .hint = ParaView sprema i s drugim sažimanjem
vtu-syntax-HeaderType = `{ $word }` nije vrsta zaglavlja
    .allowed = UInt32 ili UInt64
vtu-syntax-ByteOrder = `{ $word }` nije redoslijed bajtova
    .allowed = LittleEndian ili BigEndian
vtu-syntax-NoPiece = nema nijednog dijela (`Piece`)
    .allowed = <Piece> unutar <UnstructuredGrid>
vtu-syntax-Count = { $attribute } je `{ $word }`
    .allowed = cijeli broj do 2147483648
vtu-syntax-Second = stoji dvaput: { $what }
    .allowed = jedan
vtu-syntax-NoArray = <{ $tag }> nema polje{ $name }
    .allowed = <DataArray>
vtu-syntax-Coordinates = točke imaju koordinata: `{ $components }`
    .allowed = 3
scene-not_finite-NotFinitePoint = koordinata točke { $point } je { $number }
    .allowed = konačan broj
vtu-size-LastOffset = zadnja ćelija završava u { $offset }
    .allowed = 0 ili više
vtu-size-Reach = ćelija { $cell } seže od { $start } do { $end }
    .allowed = { $start } do { $most }
vtu-syntax-NotWhole = `{ $number }` nije cijeli broj
    .allowed = cijeli broj
vtu-syntax-NotOfArray = `{ $word }` nije broj svojeg polja
    .allowed = { $range }
vtu-size-NothingAppended = nema dodanih podataka
    .allowed = <AppendedData>
    .hint = datoteka je odrezana
vtu-size-BehindAppended = polje počinje iza kraja dodanih podataka
    .allowed = 0 do { $most }
    .hint = datoteka je odrezana
vtu-syntax-ArrayFormat = `{ $word }` nije zapis polja
    .allowed = ascii, binary ili appended
vtu-size-ArraySize = polje ima vrijednosti: { $there }, a ne { $count }
    .allowed = { $count }
    .hint = datoteka je odrezana ili su joj količine krive
vtu-size-Cut = podaci polja su odrezani
    .allowed = { $wanted } bajtova brojeva
vtu-syntax-Base64 = podaci polja nisu base64
    .allowed = A–Z a–z 0–9 + / =
vtu-syntax-Block = blok { $block } polja ne može se raspakirati
    .allowed = { $wanted } bajtova

## LeftOut

part-left_out-CellValues = `{ $name }`, što nemaju sve ćelije
part-left_out-NodeValues = `{ $name }`, što nemaju svi čvorovi
part-left_out-GappyValues = vrijednosti koje nemaju sve ćelije: { $count }
part-left_out-GroupNames = imena skupina: { $count }
part-left_out-NamesOfCellGroups = imena skupina ćelija ({ $count }): zamjenjuju ih brojevi po abecedi
part-left_out-NamesOfCellValues = imena vrijednosti ćelija: { $count }
part-left_out-Groups = skupine: { $count }
part-left_out-GroupsOfNodes = skupine čvorova: { $count }
part-left_out-ValuesOfCells = vrijednosti ćelija: { $count }
part-left_out-ValuesOfNodes = vrijednosti čvorova: { $count }
mesh-left_out-LeftOutOfFormat = izostavljeno, jer format za to nema mjesta: { $what }
