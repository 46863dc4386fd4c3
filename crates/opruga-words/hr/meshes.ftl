# What is wrong with meshes and outlines.

## Element

part-mesh_element-Facet = strana
part-mesh_element-Wire = žica
part-mesh_element-Sheet = trokut opne
part-mesh_element-SheetQuadrilateral = četverokut opne
part-mesh_element-Triangle = trokut
part-mesh_element-Quadrilateral = četverokut
part-mesh_element-Tetrahedron = tetraedar
part-mesh_element-Hexahedron = heksaedar
part-mesh_element-QuadraticTriangle = kvadratni trokut
part-mesh_element-QuadraticTetrahedron = kvadratni tetraedar
part-mesh_element-Edge = brid
part-mesh_element-Group = skupina

## Quantity

part-quantity-NumberCellsPerAxis = broj ćelija po osi
part-quantity-NumberCellsPerSide = broj ćelija po stranici
part-quantity-NumberNodesAroundAxis = broj čvorova oko osi
part-quantity-NumberNodesAroundTube = broj čvorova oko cijevi
part-quantity-NumberPoints = broj točaka
part-quantity-NumberSegments = broj odsječaka
part-quantity-NumberSides = broj stranica
part-quantity-NumberSubdivisions = broj podjela
part-quantity-NumberVerticesPerSide = broj vrhova po stranici
part-quantity-NumberVertices = broj vrhova
part-quantity-CentreMap = središte preslikavanja
part-quantity-Centre = središte
part-quantity-CoordinatePoint = koordinata točke
part-quantity-CornerQuadrilateral = ugao četverokuta
part-quantity-CornerSheet = ugao opne
part-quantity-EndLine = kraj dužine
part-quantity-EntryMap = član preslikavanja
part-quantity-LowerCornerBox = donji ugao kvadra
part-quantity-LowerCornerGrid = donji ugao rešetke
part-quantity-RotationAngle = kut zakreta
part-quantity-AreaSheet = površina opne
part-quantity-LengthEdges = duljina bridova
part-quantity-MajorRadius = veliki polumjer
part-quantity-MinorRadius = mali polumjer
part-quantity-Radius = polumjer
part-quantity-SizeBox = veličina kvadra
part-quantity-SizeGrid = veličina rešetke
part-quantity-Spacing = `spacing`
part-quantity-AreaOutline = površina obrisa
part-quantity-AreaSpannedSidesCorner = površina koju razapinju stranice u uglu
part-quantity-DeterminantMap = determinanta preslikavanja
part-quantity-Dimension = dimenzija
part-quantity-DistanceWelding = razmak spajanja
part-quantity-LengthCells = duljina polja `cells`
part-quantity-LengthRadii = duljina polja `radii`
part-quantity-StartAngle = početni kut
part-quantity-LengthNormal = duljina normale
part-quantity-LengthRotationAxis = duljina osi zakreta
part-quantity-LengthLine = duljina dužine
part-quantity-NumberCorners = broj uglova

## Must

part-must-NotNegative = 0 ili više, i konačno
part-must-TwoOrThree = 2 ili 3
part-must-NotZero = konačno i različito od nule
part-must-Finite = konačno
part-must-Turns = od -1e6 do 1e6 rad
part-must-Positive = pozitivno i konačno
part-must-Convex = pozitivno u svakom uglu: četiri ugla konveksnog četverokuta, suprotno od kazaljke na satu
part-must-BelowBody = manje od tijela: u njega ne stane nijedan tetraedar
part-must-BelowMajorRadius = manje od velikog polumjera

## MeshError

part-mesh-Count = { $what }: { $value }, a mora biti između { $least } i { $most }
part-mesh-Size = { $what }: { $value }, a mora biti { $must }
part-mesh-TooManyNodes = mreža bi imala { $nodes } čvorova, a dopušteno ih je najviše { $most }
part-mesh-NotCompared = bridova koji prolaze tijesno jedan uz drugoga: { $edges }; trebalo bi usporediti više od { $most } parova
part-mesh-RepeatedPoint = točke { $first } i { $second } slijede jedna drugu na istom mjestu
part-mesh-SelfIntersection = brid između točaka { $first } susreće brid između točaka { $second }
part-mesh-IndexOutOfRange = { $element } { $index } imenuje čvor { $node }, a čvorova je { $nodes }
part-mesh-RepeatedNode = { $element } { $index } imenuje čvor { $node } dvaput
part-mesh-CellOutOfRange = skupina `{ $group }` imenuje ćeliju { $cell }, a ćelija je { $cells }
part-mesh-CellValues = `{ $name }` ima { $values } vrijednosti za { $cells } ćelija
part-mesh-NodeValues = `{ $name }` ima brojeva: { $values }, po čvoru { $components }, a čvorova: { $nodes }
part-mesh-NotSimplices = { $element } nije trokut ni tetraedar; najprije se mora razrezati na njih
part-mesh-OddLoop = heksaedri oko brida između čvorova { $edge } ne mogu se izmjenjivati: kroz njega vodi petlja neparnog broja bridova
part-mesh-NoSpacing = nedostaje `spacing`: stranica kocaka od kojih je ispuna [m]
part-mesh-Torn = s razmakom od { $spacing } m ispuna (zatvorenih ploha: { $parts }) raspada se na { $pieces } dijelova
part-mesh-Lost = s razmakom od { $spacing } m popunjavanje bi imalo { NUMBER($kept, maximumSignificantDigits: 2) } obujma{ $finer ->
        [none] {""}
       *[other] ; { $finer } m bi ga sačuvalo
    }
part-mesh-WrongDimension = { $element } nema mjesta u mreži od { $dimension } dimenzije
part-mesh-SheetPairing = četverokut opne { $index } nije razrezan na trokute opne s dvostrukim brojem i idućim
part-mesh-Open = granica nije zatvorena: slobodnih rubova: { $loops }, kroz čvorove { $nodes }
part-mesh-NonManifoldEdges = više od dva trokuta susreću se na bridovima { $edges }
part-mesh-NonManifoldNodes = granica dodiruje samu sebe u čvorovima { $nodes }
part-mesh-NonOrientable = ploha kroz stranu { $facet } ima samo jednu stranu
part-mesh-InconsistentOrientation = strana okrenutih suprotno od susjeda: { $count }, prva je strana { $first }
part-mesh-InsideOut = dio kroz stranu { $facet } je izvrnut: obujam mu je { $signed_volume }, a nijedan ga drugi dio ne obuhvaća
part-mesh-RingsMeet = prstenovi { $first } i { $second } sijeku se ili dodiruju
part-mesh-RingsAlike = prsten { $inner } leži u prstenu { $outer }, a polumjeri su im istog predznaka
part-mesh-HoleInNothing = prsten { $ring } je rupa, jer mu je polumjer negativan, a ne leži ni u kojem drugom prstenu
part-mesh-MixedMeasures = mreža miješa elemente vrsta { $first } i { $second }, koji nemaju zajedničku mjeru

## MeetingOf

part-meeting-Itself = obris siječe ili dodiruje sam sebe
part-meeting-Others = dva obrisa sijeku se ili dodiruju

## OutlineError

shape-no_area-Empty = nema zatvorenog obrisa
shape-no_area-NoArea = obris ne obuhvaća površinu: točaka: { $points }, prva je u { $position }
scene-not_finite-NotFinite = koordinata je { $value }
shape-crossing-Meeting = { $what } blizu { $position }
shape-spacing-TooCoarse = s čvorovima na razmaku od { $spacing } m bridovi se sijeku blizu { $position }
limit-nodes-TooFine = ispunjen čvorovima na razmaku od { $spacing } m obris bi imao oko { $nodes } čvorova
limit-comparisons-NotCompared = bridova koji prolaze tijesno jedan uz drugoga: { $edges }; trebalo bi usporediti više od { $most } parova
    .allowed = bridovi od kojih najviše { $most } parova leži jedan uz drugoga
    .hint = nacrtaj obris s manje točaka
scene-shape-Mesh = { $error }
