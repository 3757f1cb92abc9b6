"""Languages: which one a sentence is written in, where it is not English.

Scripts tell most; languages in Latin letters are told by their most frequent words, by those of their lexicon of
movement and by letters that others lack. A sentence that is as much English as anything else is taken for English.
"""

from __future__ import annotations

import re
import unicodedata
from collections import Counter
from functools import cache, lru_cache

from search.query.known_words import lexicon
from search.query.vocabulary import vocabulary
from search.translation.concepts import ENGLISH, languages, telling_stems
from search.translation.english_neighbours import is_installed

#: First word of a character's Unicode name -> the language written so, where there are no others to tell it from.
_SCRIPTS = {
    "HIRAGANA": "Japanese",
    "KATAKANA": "Japanese",
    "HANGUL": "Korean",
    "CJK": "Chinese",
    "THAI": "Thai",
    "HEBREW": "Hebrew",
    "GREEK": "Greek",
    "DEVANAGARI": "Hindi",
    "ARABIC": "Arabic",
    "CYRILLIC": "Russian",
}
#: Frequent words in which people, places, directions and sides are spoken of.
_WORDS = {
    "English": "a an the and is are was then while with without to into onto of on in at by for from as his her their "
    "its it he she they who that this someone person man woman human figure something like up down back out off over "
    "under both left right hand hands arm arms leg legs one two three times not no very while pose person's",
    "German": "ein eine einen einem einer der die das den dem und ist auf mit nach vor von im zu sich er sie es jemand "
    "mensch mann frau person hand arm bein links rechts vorne hinten rückwärts vorwärts langsam schnell geht läuft "
    "springt steht sitzt setzt dreht hebt wirft winkt tanzt kniet fällt hin auf beiden seinen ihren über unter",
    "French": "un une le la les des du de et est sur avec vers en au aux se il elle quelqu'un on personne homme femme "
    "main bras jambe gauche droite avant arrière lentement vite marche court saute debout assis assoit tourne lève "
    "lance danse tombe puis dans par son ses sa qui à où",
    "Spanish": "un una el la los las del de y es en con hacia al se él ella alguien persona hombre mujer mano brazo "
    "pierna izquierda derecha adelante atrás lentamente rápido camina corre salta pie sentado sienta gira levanta "
    "lanza baila cae luego su sus que por para",
    "Italian": "un una uno il lo la gli le dei del della di e è in con verso al si lui lei qualcuno persona uomo donna "
    "mano braccio gamba sinistra destra avanti indietro lentamente veloce cammina corre salta piedi seduto siede gira "
    "alza lancia balla cade poi suo sua che per una",
    "Portuguese": "um uma o a os as do da dos das de e é em com para ao se ele ela alguém pessoa homem mulher mão "
    "braço perna esquerda direita frente trás lentamente rápido anda corre pula pé sentado senta gira levanta lança "
    "dança cai depois seu sua que por no na",
    "Dutch": "een de het en is op met naar van in zich hij zij ze iemand persoon man vrouw hand arm been links rechts "
    "vooruit achteruit langzaam snel loopt rent springt staat zit gaat draait tilt gooit danst valt dan zijn haar",
    "Polish": "i w na z do się on ona ktoś osoba człowiek mężczyzna kobieta ręka ręką noga lewo prawo lewą prawą "
    "przodu tyłu powoli szybko idzie biegnie skacze stoi siedzi siada obraca podnosi rzuca tańczy upada potem jest",
    "Turkish": "bir ve ile için doğru kişi adam kadın biri el kol bacak sol sağ sola sağa ileri geri yavaşça hızlı "
    "yürüyor koşuyor zıplıyor duruyor oturuyor dönüyor kaldırıyor atıyor dans ediyor düşüyor sonra",
    "Swedish": "en ett den det och är på med till av i sig han hon någon person man kvinna hand arm ben vänster höger "
    "framåt bakåt långsamt snabbt går springer hoppar står sitter sätter vänder lyfter kastar dansar faller sedan",
    "Danish": "en et den det og er på med til af i sig han hun nogen person mand kvinde hånd arm ben venstre højre "
    "fremad baglæns langsomt hurtigt går løber hopper står sidder sætter vender løfter kaster danser falder så",
    "Czech": "a v na s do se on ona někdo osoba člověk muž žena ruka rukou noha vlevo vpravo dopředu dozadu pomalu "
    "rychle jde běží skáče stojí sedí sedá otáčí zvedá hází tančí padá pak je",
}
#: Letters that, among these languages, are written in one.
_LETTERS = {
    "ß": "German",
    "ñ": "Spanish",
    "¿": "Spanish",
    "ã": "Portuguese",
    "õ": "Portuguese",
    "œ": "French",
    "û": "French",
    "ł": "Polish",
    "ż": "Polish",
    "ś": "Polish",
    "ğ": "Turkish",
    "ı": "Turkish",
    "ş": "Turkish",
    "ø": "Danish",
    "ř": "Czech",
    "ě": "Czech",
    "ů": "Czech",
}
_BY_LANGUAGE = {language: frozenset(words.split()) for language, words in _WORDS.items()}
_WORD = re.compile(r"[^\W\d_]+(?:'[^\W\d_]+)?")
#: Share of a sentence's words that must be a language's.
_SHARE = 0.34


@lru_cache(4096)
def language_of(sentence: str) -> str:
    """The English name of the language of a sentence; empty where the evidence names none, as for English itself."""
    text = unicodedata.normalize("NFC", sentence).lower()
    letters = [character for character in text if character.isalpha()]
    scripts = Counter(unicodedata.name(letter, "").partition(" ")[0] for letter in letters)
    foreign = [script for script in _SCRIPTS if scripts[script] >= 2]
    if foreign and sum(scripts[script] for script in foreign) > len(letters) / 2:
        return _SCRIPTS[foreign[0]]
    words = _WORD.findall(text)
    if sum(word in _english() for word in words) > len(words) / 2:
        return ""
    evidence = Counter({language: sum(_is_of(word, language) for word in words) for language in _WORDS})
    evidence.update(_LETTERS[letter] for letter in set(text) & _LETTERS.keys())
    first, most = max(evidence.items(), key=lambda entry: entry[1])
    if len(words) == 1 and text.isascii():  # beginnings of single words say little
        most = min(most, words[0] in _BY_LANGUAGE[first])
    enough = words and most >= min(max(2, _SHARE * len(words)), len(words))
    return first if enough and most > evidence[ENGLISH] else ""


def understood_language_of(sentence: str) -> str:
    """The language of a sentence that is not English and can be answered here; empty for any other."""
    language = language_of(sentence)
    return language if language in languages() and is_installed() else ""


@cache
def _english() -> frozenset[str]:
    """English words by which a sentence is known for English at once."""
    return _BY_LANGUAGE[ENGLISH] | frozenset(lexicon(vocabulary()).tolist())


def _is_of(word: str, language: str) -> bool:
    """Whether a word is a frequent one of a language, or one of its words of movement."""
    if word in _BY_LANGUAGE[language] or (language == ENGLISH and word in _english()):
        return True
    if language not in languages():
        return False
    beginnings, whole = telling_stems(language)
    return word in whole or any(word[:end] in beginnings for end in range(4, len(word) + 1))
