"""Frames on the wire: conversion to and from bytes, checksums and signatures. Payloads are not decoded here."""
