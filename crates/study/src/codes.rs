//! The codes of errors of studies, beside those of their text.

data_file::codes! {
    SCENE = "T001": "A scene is not there, or cannot be loaded.";
    PIPELINE = "T002": "A pipeline is not there, or is broken.";
    PATH = "T003": "An axis or a value names a parameter or setting that a pipeline does not have.";
    VALUE = "T004": "A value is of the wrong type, out of range, or not one of the choices.";
    EMPTY = "T005": "There is nothing to run: no scenes, no pipelines, an axis without values, no frames, no seeds.";
    TWICE = "T006": "A scene, a variant's name, an axis, a value, a seed, a measure or a pass is given twice.";
    PAIRED = "T007": "Axes that are paired have different numbers of values.";
    MEASURE = "T008": "There is no measure of that name.";
    NEEDS = "T009": "A measure lacks what it needs: a reference, several frames, several seeds, a jump.";
    OUTPUT = "T010": "A pipeline has no output of that name.";
    BUDGET = "T011": "A budget cannot be met: what it sets is varied as well, or is no whole number.";
    RANGE = "T012": "A number is out of range.";
    REFERENCE = "T013": "What a reference names is not there.";
    PHASE = "T014": "A phase names a pass that no pipeline of the study has.";
    CLAIM = "T015": "A claim names what is not measured, run or varied, or says nothing that could fail.";
    FIGURE = "T016": "There is no such figure among those of the passes of the study.";
    COLD = "T017": "Times are measured without a frame before them, in which the driver compiles.";
    COMMAND = "T018": "The command of an external program cannot be run as it is written: a placeholder is missing or unknown, or a quotation mark is open.";
}
