"""Side files: what is taken as a caption, and the warnings about the rest."""

import pytest

from indexer.ingest.caption_files import read_lines, read_table
from indexer.store.captions import CaptionRow


@pytest.fixture
def table(tmp_path):
    def read(text, name="captions.csv", folder=""):
        path = tmp_path / name
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        warnings = []
        return read_table(path, folder, warnings.append), [w.removeprefix(f"{path}") for w in warnings]

    return read


def test_a_table_names_files_captions_spans_frame_rates_and_axes(table):
    rows, warnings = table(
        'path,text,start,end,fps,up\na.bvh,a person walks,,,,\nb/c.bvh,"sits down, slowly",1.5,3,,\n'
        "d.amc,,,,60,\ne.bvh,,,,, -Z\n"
    )
    assert rows == [
        CaptionRow("a.bvh", "a person walks"),
        CaptionRow("b/c.bvh", "sits down, slowly", 1.5, 3.0),
        CaptionRow("d.amc", fps=60.0),
        CaptionRow("e.bvh", up="-z"),
    ]
    assert warnings == []


def test_paths_are_relative_to_the_tables_folder(table):
    rows, _ = table("path,text\nx.bvh,one\n../y.bvh,two\nd\\z.bvh,three\n", folder="takes/day 1")
    assert [row.path for row in rows] == ["takes/day 1/x.bvh", "takes/y.bvh", "takes/day 1/d/z.bvh"]


def test_columns_come_in_any_order_and_others_are_ignored(table):
    rows, _ = table("Text\tactor\tPATH\nwaves\tAnna\ta  b.bvh\n", "captions.tsv")
    assert rows == [CaptionRow("a  b.bvh", "waves")]


def test_windows_line_ends_a_byte_order_mark_and_umlauts_are_fine(table):
    rows, warnings = table(b"\xef\xbb\xbfpath,text\r\n" + "für Elise.bvh,tänzelt\r\n".encode())
    assert rows == [CaptionRow("für Elise.bvh", "tänzelt")]
    assert warnings == []


def test_lines_of_json(table):
    rows, warnings = table(
        '{"path": "a.bvh", "text": "walks"}\n\n{"path": "a.bvh", "text": "turns", "start": 1, "end": 2.5}\n',
        "captions.jsonl",
    )
    assert rows == [CaptionRow("a.bvh", "walks"), CaptionRow("a.bvh", "turns", 1.0, 2.5)]
    assert warnings == []


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("a.bvh,,,,", "it has no text"),
        (",walks,,,", "it names no path"),
        ("/etc/a.bvh,walks,,,", "must be relative"),
        ("../../a.bvh,walks,,,", "must be relative"),
        ("C:\\a.bvh,walks,,,", "must be relative"),
        ("a.bvh,walks,2,1,", "the end after the start"),
        ("a.bvh,walks,1,,", "must both be given"),
        ("a.bvh,walks,-1,1,", "the end after the start"),
        ("a.bvh,walks,soon,3,", "start 'soon' is no number"),
        ("a.bvh,walks,nan,3,", "is no number"),
        (f"a.bvh,walks,{'9' * 400},3,", "start '9999"),
        ("a.bvh,walks,,,0", "fps=0 is no frame rate"),
        ("a.bvh,walks,,,,up", "up='up' is no axis; it must be one of x, y, z, -x, -y, -z"),
        ("a.bvh," + "x" * 3000 + ",,,", "3000 characters are more than 2000"),
    ],
)
def test_a_bad_row_is_reported_with_its_line_and_the_rest_is_read(table, line, reason):
    rows, warnings = table(f"path,text,start,end,fps,up\ngood.bvh,walks,,,\n{line}\nlast.bvh,runs,,,\n")
    assert [row.path for row in rows] == ["good.bvh", "last.bvh"]
    assert len(warnings) == 1
    assert warnings[0].startswith(", line 3: ")
    assert reason in warnings[0]


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("{", "no JSON"),
        ("[1]", "is expected"),
        ('{"path": "a", "text": "b", "start": true, "end": 2}', "is no number"),
        ('{"path": "a", "text": "b", "start": %s, "end": 1}' % ("9" * 400), "start 9999"),
        ('{"path": "a", "text": "b", "fps": %s}' % ("9" * 9000), "line 1"),
    ],
)
def test_a_bad_line_of_json_is_reported(table, line, reason):
    rows, warnings = table(line + '\n{"path": "a.bvh", "text": "walks"}\n', "captions.jsonl")
    assert [row.path for row in rows] == ["a.bvh"]
    assert warnings[0].startswith(", line 1: ")
    assert reason in warnings[0]


def test_a_table_without_its_header_is_reported(table):
    rows, warnings = table("a.bvh,a person walks\n")
    assert rows == []
    assert "the first line must name the columns" in warnings[0]


def test_bytes_that_are_no_text_are_reported(table):
    rows, warnings = table(b"path,text\na.bvh,\xff\xfe\nb.bvh,walks\n")
    assert [row.path for row in rows] == ["b.bvh"]
    assert "line 2: it is not UTF-8" in warnings[0]


def test_every_line_of_a_text_file_is_a_caption(tmp_path):
    (tmp_path / "a.txt").write_text("a person walks\n\n  and  turns \n")
    warnings = []
    assert read_lines(tmp_path / "a.txt", warnings.append) == [
        ("a person walks", None, None),
        ("and turns", None, None),
    ]
    assert warnings == []


def test_text_files_of_humanml3d_give_text_and_span(tmp_path):
    (tmp_path / "a.txt").write_text(
        "a man kicks.#a/DET man/NOUN kick/VERB#0.0#0.0\nhe sits#he/PRON sit/VERB#2.0#4.5\nx#y#nan#nan\nis #1#a#hit\n"
    )
    assert read_lines(tmp_path / "a.txt", print) == [
        ("a man kicks.", None, None),
        ("he sits", 2.0, 4.5),
        ("x", None, None),
        ("is #1#a#hit", None, None),
    ]


def test_a_text_file_that_is_no_list_of_captions_is_cut_off(tmp_path):
    (tmp_path / "log.txt").write_text("line\n" * 5000)
    warnings = []
    assert len(read_lines(tmp_path / "log.txt", warnings.append)) == 1000
    assert "only the first 1000 lines" in warnings[0]


@pytest.mark.parametrize("delimiter", [",", ";", "\t", "|"])
def test_a_table_may_be_delimited_as_programs_export_it(table, delimiter):
    lines = ["path,text,start,end", "a.bvh,waves,1.5,2.25"]
    rows, warnings = table("\n".join(line.replace(",", delimiter) for line in lines))
    assert (rows, warnings) == ([CaptionRow("a.bvh", "waves", 1.5, 2.25)], [])


def test_a_comma_is_a_decimal_sign_between_semicolons(table):
    rows, warnings = table("path;text;start;end\na.bvh;waves, then sits;1,5;2,25\n")
    assert (rows, warnings) == ([CaptionRow("a.bvh", "waves, then sits", 1.5, 2.25)], [])


def test_a_header_that_lacks_columns_is_quoted(table):
    _, warnings = table("file;sentence\na.bvh;waves\n")
    assert "path and text among them" in warnings[0]
    assert "it says 'file;sentence'" in warnings[0]


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
def test_unicode_is_read_in_the_encodings_that_programs_write(tmp_path, encoding):
    mark = "\ufeff" if encoding in ("utf-16-le", "utf-16-be") else ""
    (tmp_path / "captions.csv").write_bytes(f"{mark}path,text\ngröße.bvh,übt\n".encode(encoding))
    rows = read_table(tmp_path / "captions.csv", "", pytest.fail)
    assert rows == [CaptionRow("größe.bvh", "übt", None, None)]
