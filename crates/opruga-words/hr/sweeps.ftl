# What is wrong with sweeps.

## RangeFault

part-range_fault-Ends = krajevi raspona nisu brojevi
part-range_fault-TwoLogs = raspon dvaput ima `log`
part-range_fault-TwoWholes = raspon dvaput ima `whole`
part-range_fault-TwoCounts = raspon ima dva broja vrijednosti
part-range_fault-Count = raspon ima nevaljan broj vrijednosti; najmanji je 2
part-range_fault-Word = raspon ima nepoznat dio
part-range_fault-Order = donji kraj nije ispod gornjega
part-range_fault-Ratios = raspon jednakih omjera mora početi iznad 0

## RowFault

part-row_fault-NoChecksums = redci nemaju kontrolne zbrojeve: tablicu je napisala starija inačica programa
part-row_fault-Head = zaglavlje tablice ne pripada ovom nizu
part-row_fault-TwoRows = tablica ima dva retka ove točke
part-row_fault-Quote = redak ima navodnik bez kraja
part-row_fault-Cells = redak ima drugi broj polja od zaglavlja
part-row_fault-PointNumber = nevaljan broj točke
part-row_fault-NoPoint = niz nema takvu točku
part-row_fault-Values = redak ima vrijednosti druge točke
part-row_fault-Status = stanje nedostaje
part-row_fault-Number = redak ima nevaljan broj

## SweepError

sweep-values-ControlCharacter = vrijednost sadrži upravljački znak
    .allowed = vrijednosti u jednom retku
sweep-values-NoValue = popisu nedostaje vrijednost
    .allowed = vrijednosti s po jednim zarezom među sobom
sweep-range-InvalidRange = { $fault }
    .allowed = DONJI..GORNJI:BROJ, uz :log za jednake omjere i :whole za cijele brojeve
    .hint = na primjer 10..1000:log:7 ili 0.1..0.9:5
sweep-axes-NothingVaries = nijedan se parametar ne mijenja
    .hint = na primjer --set body.ball.mass=1,2,4 ili --set body.ball.mass=1..4:7
sweep-axes-VariesTwice = parametar se mijenja dvaput
sweep-range-SampleWithCount = uzorak sam bira broj vrijednosti
    .allowed = { $range }
sweep-range-NoCount = rasponu nedostaje broj vrijednosti
    .allowed = { $range }:BROJ, ili --sample BROJ
sweep-range-EmptySample = uzorak od 0 točaka ne posjećuje ništa
    .allowed = 1 do { $most }
    .hint = na primjer --sample 20
sweep-too_many-TooManyPoints = niz ima točaka: { $count }
    .allowed = najviše { $most }
sweep-damaged-Question = program ne može pročitati pitanje niza: „{ $reason }”
    .hint = --force počinje niz iznova
sweep-damaged-QuestionVersion = pitanje niza ima inačicu { $found }; ovaj program čita inačicu { $version }
    .hint = --force počinje niz iznova
sweep-damaged-FileOfSweep = program ne može pročitati datoteku `{ $name }` niza
    .hint = --force počinje niz iznova
sweep-damaged-Table = { $fault }
    .hint = --force počinje niz iznova, --out uzima drugu mapu
sweep-changed_row-ChangedRow = redak je promijenjen nakon što ga je niz zapisao: kontrolni mu je zbroj drugi
    .allowed = redak kakav je zapisan
    .hint = bez njegova retka program točku računa ponovno; --force počinje cijeli niz iznova, --out uzima drugu mapu
sweep-metric-NothingMeasured = niz ništa ne mjeri
    .allowed = --metric { $words } te PROBE.COLUMN.min, .max, .mean, .last
    .hint = na primjer --metric bounce_height --metric settling_time
sweep-metric-MetricTwice = mjera stoji dvaput
sweep-metric-NoMetric = nema mjere `{ $metric }`
    .allowed = { $words } te PROBE.COLUMN.min, .max, .mean, .last
sweep-metric-NoBodyToMeasure = nema tijela `{ $body }`
sweep-metric-NoColumn = nema stupca `{ $column }` sonde
sweep-metric-NoUp = ništa u prizoru ne kaže gdje je gore
    .allowed = prizori s gravitacijom ili poluprostorom

## SweepAllowed

part-sweep_allowed-SceneHasNone = prizor ih nema
