"""The pages of luts/report/: speed against error, hard cases, the study behind the design."""
