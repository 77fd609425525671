//! Words of column names in English, and the commonest in German, French, Spanish and Italian; accents and capitals taken off.

pub const SPECIMEN: &str = "specimen specimens sample coupon probe eprouvette probeta provino panel";
pub const SPECIMEN_MORE: &str = "specimen id name no nr number nummer label";

pub const CYCLES: &str = "cycle cycles cyc n ncycles zyklen zyklus zykluszahl zyklenzahl gesamtzyklen lastwechsel lastwechselzahl lastspiele lastspielzahl \
    schwingspiele schwingspielzahl ciclos ciclo cicli cyclecount kilocycles kcycles megacycles mcycles kilocycle megacycle";
pub const CYCLES_MORE: &str = "elapsed total number num no nr of count counts counter cumulative cumulated cum accumulated fatigue axial load loading \
    test the anzahl der nombre de numero di running machine applied gesamt gesamtzahl nb totale totales";
/// `Axial Count` has no other word for cycles.
pub const COUNTS: &str = "count counts";

pub const LENGTH: &str = "a 2a length len risslaenge risslange rissl fissure grieta cricca cracklength cracksize crack";
pub const LENGTH_MORE: &str = "crack size average avg ave av mean mittlere mittel mittelwert visual optical measured current corrected physical \
    fatigue the of length longueur longitud lunghezza de la della moyenne media flaw a half halbe";
/// How a crack length was measured, beside a word or a unit of length.
pub const METHODS: &str = "dcpd acpd pd dc ac by potential drop method";
pub const SIDES: &str = "front back rear left right afront aback aleft aright vorne hinten links rechts vorderseite rueckseite vorn avant arriere gauche droite near far";
/// Letters of sides, beside a word of length only.
pub const SIDE_LETTERS: &str = "f b l r fl fr bl br lf rf lb rb";
pub const SIDE_MORE: &str = "side face surface seite tip cote";

pub const FORCE: &str = "force load p f kraft last charge fuerza carga forza carico";
pub const STRESS: &str = "stress sigma s spannung contrainte tension tensione";
pub const LOAD_MORE: &str = "axial applied cyclic nominal gross remote test cell far field of cycle the";
pub const RANGE: &str = "range delta schwingbreite";
/// Loads from which nothing follows.
pub const PART: &str = "amplitude mean mittel average";
pub const MAX: &str = "max maximum maximal maximale peak upper ober obere maxi maximo massimo";
pub const MIN: &str = "min minimum minimal minimale valley lower unter untere mini minimo trough";
/// A load and its extreme in one word.
pub const MAX_WORDS: &str = "pmax fmax loadmax maxload forcemax maxforce oberlast oberkraft maximallast hoechstlast";
pub const MIN_WORDS: &str = "pmin fmin loadmin minload forcemin minforce unterlast unterkraft minimallast";
pub const RANGE_WORDS: &str = "dp df deltap deltaf dload dforce prange frange loadrange forcerange";
pub const RANGE_STRESS: &str = "ds dsigma dstress deltas deltasigma srange sigmarange stressrange";
pub const MAX_STRESS: &str = "smax sigmamax maxstress stressmax oberspannung";
pub const MIN_STRESS: &str = "smin sigmamin minstress stressmin unterspannung";

/// Words of columns that say whether a reading counts: of those that do, of those that do not, of either, and beside them.
pub const MARKS_KEEP: &str = "valid valide valido valida gueltig validity use used include included accept accepted keep";
pub const MARKS_OUT: &str = "exclude excluded reject rejected outlier outliers discard discarded omit omitted invalid ungueltig";
pub const MARKS: &str = "flag flags flagged";
pub const MARKS_MORE: &str =
    "data point points reading readings row rows in from for fit fitting the of is regression analysis e647 astm per";

/// Names of the range of stress intensity.
pub const DELTA_K: [&str; 12] = [
    "delta k",
    "dk",
    "deltak",
    "delta ki",
    "delta k i",
    "delta k app",
    "k range",
    "sif range",
    "delta sif",
    "stress intensity range",
    "stress intensity factor range",
    "range of stress intensity",
];
/// Names of the stress intensity at one load, as it is called beside `max` or `min`.
pub const K_AT: [&str; 6] = ["k", "k i", "ki", "sif", "stress intensity", "stress intensity factor"];
/// Names of the growth in a cycle.
pub const RATE: [&str; 9] = [
    "da dn",
    "dadn",
    "growth rate",
    "crack growth rate",
    "fatigue crack growth rate",
    "fcgr",
    "fcg rate",
    "rissfortschritt",
    "rissfortschrittsrate",
];

/// Words of other quantities of a test, of results of this program and of remarks.
pub const OTHER: &str = "k kmax kmin ki kii dk deltak keff kop kcl dkeff intensity sif j da dn dadn rate growth extension increment cod cmod \
    ctod clip gauge gage displacement disp stroke opening position strain bfs compliance stiffness time date zeit datum \
    temps elapsed seconds hours temperature temp temperatur humidity frequency freq frequenz b w h e thickness width \
    height dicke breite modulus area r2 flag flags valid validity comment comments note notes remark remarks bemerkung \
    closure voltage potential pd dcpd acpd vpd line point index row file block broken bonds work x y t tip beta error residual \
    fit fitted p f force load stress range amplitude segment segments gain phase waveform u v pop pcl energy ratio delta \
    step method operator q cross check remaining band measured dp df uneven";

/// Whether a word is one of a list.
pub fn is_in(list: &str, word: &str) -> bool {
    list.split_whitespace().any(|known| known == word)
}

/// Lower-case words of a name, and those of a last bracket. `Crack length (front)`, `Crack length (a)`: a bracket of words is part of the name.
pub fn words(name: &str) -> (Vec<String>, Vec<String>) {
    let is_side = |word: &str| is_in(SIDES, word) || is_in(SIDE_MORE, word) || ["a", "2a"].contains(&word);
    crate::table::words::words(name, |word| is_side(word) || is_in(MAX, word) || is_in(MIN, word))
}
