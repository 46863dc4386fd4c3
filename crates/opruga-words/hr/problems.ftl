## Words around errors and warnings.

part-label-Error = greška
part-label-Warning = upozorenje
part-label-Note = napomena
part-label-Allowed = dopušteno
part-label-Hint = savjet
part-label-Times = { $count } { $count ->
        [one] put
       *[other] puta
    }
part-label-Nearest = misliš li `{ $word }`?
part-label-NotStrict = bez --strict ovo je upozorenje
part-label-AtByte = , u bajtu { $byte }
part-label-AtTime = u t = { $time } s: { $about }
    .allowed = { ALLOWED($about) }
    .hint = { HINT($about) }
