"""The methods text: all sections in the order of APA's reporting standards for quantitative research.

Source: Appelbaum et al., Journal article reporting standards for quantitative research in psychology (2018), tables 1
and 2; the flow of participants after CONSORT (2010).
"""

from collections.abc import Iterator, Mapping

from thbridge.experiment.export.methods.design import design_section
from thbridge.experiment.export.methods.groups import groups_section
from thbridge.experiment.export.methods.markdown import listing, paragraph, sentence
from thbridge.experiment.export.methods.materials import materials_section
from thbridge.experiment.export.methods.measures import measures_section
from thbridge.experiment.export.methods.participants import participants_section, sample_size_section
from thbridge.experiment.export.methods.procedure import procedure_section
from thbridge.experiment.export.methods.quality import exclusions_section, quality_section
from thbridge.experiment.export.tables import ExperimentRecords


def methods_text(records: ExperimentRecords, versions: Mapping[str, str], registered: str) -> str:
    """Return the text. For information that is not in the design or log, the text has a gap in [brackets].

    Args:
        records: records of the experiment.
        versions: versions of the programs.
        registered: sentence about the preregistration.
    """
    return "\n".join(_lines(records, versions, registered)).rstrip("\n") + "\n"


def _lines(records: ExperimentRecords, versions: Mapping[str, str], registered: str) -> Iterator[str]:
    people = "simulated participants" if records.is_rehearsal else "participants"
    yield f"# {' '.join(records.design.file.title.split())}"
    yield ""
    if records.is_rehearsal:
        yield from paragraph("**This is a rehearsal by programs. No number below describes human participants.**")
    yield from paragraph("*Replace all text in [brackets]. All other text comes from the study and its log.*")
    yield "## Method"
    yield ""
    yield from participants_section(records, people)
    yield from sample_size_section(records)
    yield from design_section(records, people)
    yield from groups_section(records, people)
    yield from materials_section(records, versions, people)
    yield from measures_section(records)
    yield from procedure_section(records, people)
    yield from quality_section(records)
    yield from exclusions_section(records)
    yield from _analysis(records, registered)


def _analysis(records: ExperimentRecords, registered: str) -> Iterator[str]:
    file = records.design.file
    yield "### Analytic strategy"
    yield ""
    yield from paragraph(
        "[Hypotheses with their tests, confirmatory and exploratory; software; level of significance; correction for "
        "several tests. The export's `analysis.py` and `analysis.R` compare conditions and groups, with effect sizes, "
        "confidence intervals and Holm's correction. State whether you used these scripts.]"
    )
    yield "### Preregistration and deviations"
    yield ""
    yield from paragraph(
        registered, sentence(file.preregistration, "State where the study was registered, or that it was not.")
    )
    if file.deviations:
        yield from paragraph("Deviations from the preregistration:")
        yield from listing(file.deviations)
    else:
        yield from paragraph("[State each deviation from the preregistration with its reason, or that there was none.]")
    yield "### Availability of data and materials"
    yield ""
    yield from paragraph(
        sentence(
            file.data_availability,
            "State where data, analysis code and materials are, and the license; or why they cannot be shared.",
        ),
        "The study's folder has its design, texts and forms. The same release of the program can run the study again. "
        "The exported data follow Psych-DS.",
    )
