"""Missions: how they are uploaded and downloaded, what their items mean, and how one is carried out."""
