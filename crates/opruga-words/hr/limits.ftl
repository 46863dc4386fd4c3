# What a file or a scene may ask for, and what its numbers have rounded away.

## Counted

part-counted-Outlines = zatvorenih obrisa
part-counted-Points = točaka obrisa
part-counted-Pixels = piksela
part-counted-Elements = elemenata crteža
part-counted-Text = bajtova ponovljenog teksta
part-counted-Rules = usporedaba pravila s elementima
part-counted-Vertices = ponovljenih vrhova
part-counted-Numbers = brojeva u poljima
part-counted-Values = vrijednosti ili pripadnosti skupinama

## LimitHint

part-limit_hint-Picture = uzmi sliku s manje mrlja: zaglađenu ili nacrtanu s manje boja
part-limit_hint-Entities = napiši crtež bez entiteta ili s elementom `use`
part-limit_hint-Letters = slova ovog fonta sastavljena su od previše drugih
part-limit_hint-Instances = nacrtaj mrežu manje puta ili izostavi što tijelu ne treba
part-limit_hint-Compression = spremi datoteku bez sažimanja

## LimitError

part-limit-Above = datoteka traži { $count } { $what } ili više
    .allowed = najviše { $most } { $what }

## CostError

limit-bodies-Bodies = prizor ima { $count } tijela ili više
    .allowed = najviše { $most } tijela
limit-nodes-Nodes = prizor ima { $count } čvorova ili više
    .allowed = najviše { $most } čvorova
limit-memory-Memory = prizor bi zauzeo oko { $count } bajtova ili više
    .allowed = najviše { $most } bajtova
limit-nodes-MeshNodes = mreža bi imala { $count } čvorova ili više
    .allowed = najviše { $most } čvorova
limit-memory-MeshMemory = mreža bi zauzela oko { $count } bajtova ili više
    .allowed = najviše { $most } bajtova

## Rounded

mesh-rounded-Single = datoteka zaokružuje koordinate za najviše { $rounding } m, { $percent } % razmaka susjednih čvorova: leže do { $farthest } m od ishodišta u brojevima od 4 bajta
    .allowed = do { $warned } %; iznad { $refused } % je pogreška
    .hint = pomakni oblik u ishodište prije spremanja ili ga spremi u zapisu s brojevima od 8 bajtova
mesh-rounded-Double = datoteka zaokružuje koordinate za najviše { $rounding } m, { $percent } % razmaka susjednih čvorova: leže do { $farthest } m od ishodišta u brojevima od 8 bajtova
    .allowed = do { $warned } %; iznad { $refused } % je pogreška
    .hint = pomakni oblik u ishodište prije spremanja
